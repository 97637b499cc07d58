# cmake -DOUTPUT=x.cc "-DFILES=name=path;name=path" -P embed.cmake
# Writes a C++ file that defines each name in sandglass::page_files as the bytes of its file.
set(source "#include \"sandglass/report/page_files.h\"\n\nnamespace sandglass::page_files {\n")
foreach(item IN LISTS FILES)
  string(REGEX MATCH "^([a-z_]+)=(.*)$" _ "${item}")
  set(name ${CMAKE_MATCH_1})
  file(READ "${CMAKE_MATCH_2}" bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND source "static const unsigned char ${name}_bytes[] = {${bytes}};\n"
                       "const std::string_view ${name}{reinterpret_cast<const char*>(${name}_bytes), sizeof ${name}_bytes};\n")
endforeach()
string(APPEND source "}  // namespace sandglass::page_files\n")
file(WRITE "${OUTPUT}" "${source}")
