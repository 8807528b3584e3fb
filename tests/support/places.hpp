#pragma once

#include <filesystem>
#include <string>

namespace offnominal::test {

// Where this build and its checkout lie, absolute. They stand in a unit of their own: in the
// command line of every test they would keep another clone from using what ccache remembers.
std::filesystem::path source_dir();
std::string command_file();     // offnominal
std::string controller_file();  // offnominal-controller
std::string wcet_file();        // offnominal-wcet

}  // namespace offnominal::test
