#pragma once

#include <string>
#include <string_view>

#include "own_controller.hpp"

namespace busbar::bench {

/// Someone who administers an OwnController by the program `busbar`. Any thread.
class ToolUser {
public:
    /// `program` is its file. `controller` must outlive this.
    ToolUser(const OwnController& controller, const std::string& program);

    /// Makes a certificate of the tool that the controller trusts, and, in the controller's folder,
    /// the files that commands name: "password", "spare.der" with its "thumbprint".
    [[nodiscard]] bool prepare() const;
    /// Runs `busbar` with these words of a shell in the controller's folder, for the account of
    /// this name. Returns whether it ended well, within a minute.
    [[nodiscard]] bool run(std::string_view user, std::string_view words) const;

private:
    [[nodiscard]] bool execute(std::string_view words) const;

    const OwnController& controller_;
    std::string program_;
};

} // namespace busbar::bench
