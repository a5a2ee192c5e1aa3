#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

namespace busbar::tool {

/// Arithmetic with numbers and names, as "Level * 2 + (Rate - 1)" or "Level > 90": + - * / with
/// their usual order, parentheses, a sign, and at most one comparison < <= > >= = !=, whose value
/// is 1 or 0. At most 1,000 characters and 50 parentheses within each other.
class Expression {
public:
    /// The error says what was found and what is expected.
    [[nodiscard]] static Expected<Expression, std::string> parse(std::string_view text);

    /// The names in it, in their order.
    [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
    /// Returns its value; nothing if `number_of` has none for a name in it.
    [[nodiscard]] std::optional<double>
    value(const std::function<std::optional<double>(const std::string&)>& number_of) const;

private:
    class Parser;
    /// A number, a name by its place in names_, or what is done with the last two of the stack.
    struct Step {
        enum class Kind : std::uint8_t { Number, Name, Negate, Operation };
        Kind kind{Kind::Number};
        double number{0};
        std::size_t name{0};
        /// "+", "<=".
        std::string operation;
    };

    std::vector<Step> steps_;
    std::vector<std::string> names_;
};

} // namespace busbar::tool
