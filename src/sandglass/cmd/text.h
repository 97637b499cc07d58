// What is printed for people, and for their shells.
#pragma once

#include <string>
#include <string_view>

namespace sandglass {

/// "3 min 20 s"; "an unknown time" for what is no time.
std::string duration_text(double seconds);

/// `word` as a shell reads it back as one word: quoted where it must be. Bytes that would act on the terminal are
/// written as escapes, in the $'...' form of bash, ksh and zsh.
std::string shell_word(std::string_view word);

}  // namespace sandglass
