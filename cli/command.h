#pragma once
// The table of commands.

#include <functional>
#include <string>
#include <vector>

#include "cli/session.h"

namespace CLI {
class App;
}

namespace carat::cli {

/// One command of the program.
struct Command {
  const char* name;
  const char* title;     ///< one line
  const char* details;   ///< what it does, for its help
  const char* examples;  ///< lines to try, for its help
  bool is_app;           ///< solves a problem with the operators: `carat list apps`
  /// Declares the options. What it returns runs the command after they are parsed.
  std::function<void(Session&)> (*declare)(CLI::App& app);
};

#define CARAT_COMMAND(name) extern const Command name##_command;
#include "cli/commands.def"
#undef CARAT_COMMAND

/// In the order of commands.def.
const std::vector<const Command*>& commands();

}  // namespace carat::cli
