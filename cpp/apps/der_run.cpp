#include "der/app/program.hpp"

int main(int argc, char** argv) { return der::app::run_program(argc, argv); }
