// The sub-commands: each parses its arguments, calls the library, and returns an exit code.
#pragma once

namespace sandglass {

int run_command(int argc, char** argv);
int prepare_command(int argc, char** argv);
int analyze_command(int argc, char** argv);
int sweep_command(int argc, char** argv);
int figures_command(int argc, char** argv);
int bench_command(int argc, char** argv);
int info_command(int argc, char** argv);

}  // namespace sandglass
