// The files of the page, put into the program when it is built (embed.cmake).
#pragma once

#include <string_view>

namespace sandglass::page_files {

extern const std::string_view html, style, script, plot, library, library_style, library_licence;

}  // namespace sandglass::page_files
