// The files of the pages, and what draws figures with matplotlib, put into the program when it is built (embed.cmake).
#pragma once

#include <string_view>

namespace sandglass::page_files {

extern const std::string_view frame, frame_script, style, plot, figure, run_content, run_script, study_content,
    study_script, library, library_style, library_licence, python_drawing;

}  // namespace sandglass::page_files
