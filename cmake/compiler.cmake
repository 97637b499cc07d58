# One place for everything that decides what bits the program computes.
#
# A trajectory must not depend on the compiler's freedom with floating point: no contraction of a * b + c into one
# rounding unless the source says fma, no re-association, no x87. The hot loop alone is compiled for several
# instruction sets (src/sandglass/dynamics/CMakeLists.txt) and chosen at run time; nothing is built -march=native.
add_compile_options(-ffp-contract=off -fno-fast-math -fno-math-errno -fno-trapping-math)
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor)
if(SANDGLASS_WERROR)
  add_compile_options(-Werror)
endif()
if(SANDGLASS_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
if(SANDGLASS_FUZZ)
  # Coverage of every file guides libFuzzer; only the targets themselves have its main().
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
