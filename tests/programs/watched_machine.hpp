#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "programs/controllers.hpp"
#include "support/terminal.hpp"

namespace busbar::test {

/// A busbar-controller whose variables and events `busbar watch` shows.
class Machine {
public:
    Machine();

    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + controller.port(); }
    /// `busbar watch` of it.
    [[nodiscard]] std::vector<std::string>
    command(const std::vector<std::string>& options = {}) const;
    /// The same in a terminal.
    [[nodiscard]] std::unique_ptr<Terminal> watch(TerminalSize size,
                                                  const std::vector<std::string>& options = {},
                                                  Environment environment = {}) const;

    ScratchFolder scratch;
    Controller controller;
};

/// Whether a line is as the pattern has it, in which % stands for any one character, ~ for the rest
/// of the line.
[[nodiscard]] bool matches(std::string_view line, std::string_view pattern);

/// Waits for the picture of the file in tests/programs/screens, then says of each line that does
/// not come what it is.
void check_screen(Terminal& terminal, const std::string& name);

/// The terminal is as it was before.
void check_given_back(const Terminal& terminal);

} // namespace busbar::test
