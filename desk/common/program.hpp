// What every program but the command has around its work.
#pragma once

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "common/error.hpp"
#include "common/meant_option.hpp"
#include "common/numeric_options.hpp"
#include "common/output_file.hpp"

namespace offnominal::desk {

/// Parses the arguments into `Options` and returns run(options), or 2 after one line that says what
/// is wrong. `is_page` knows a page that another may replace.
template <typename Options>
int run_program(const std::string& name, const std::string& description, int argc, char** argv,
                void (*add_options)(CLI::App&, Options&), int (*run)(const Options&),
                bool (*is_page)(const std::filesystem::path&) = nullptr) {
  CLI::App app{description, name};
  Options options;
  try {
    add_options(app, options);
    app.parse(argc, argv);
    check_numbers(app);
    check_outputs(app, is_page);
    const int exit_code = run(options);
    std::cout.flush();
    return exit_code;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::string meant = meant_option(app);
    std::cerr << name << ": " << on_one_line(error.what())
              << "; to mend: " << (meant.empty() ? "" : meant + ", or ") << "run `" << name
              << " --help`\n";
  } catch (const InputError& error) {
    std::cerr << error.what() << '\n';
  } catch (const std::exception& error) {
    std::cerr << name << ": " << on_one_line(error.what()) << '\n';
  }
  constexpr int kBadInput = 2;
  return kBadInput;
}

}  // namespace offnominal::desk
