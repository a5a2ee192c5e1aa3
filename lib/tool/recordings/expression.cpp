#include "expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::tool {

namespace {

constexpr std::size_t max_expression = 1'000;
constexpr std::size_t max_parentheses = 50;

bool is_name_character(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

double operate(std::string_view operation, double a, double b)
{
    if (operation == "+") {
        return a + b;
    }
    if (operation == "-") {
        return a - b;
    }
    if (operation == "*") {
        return a * b;
    }
    if (operation == "/") {
        return a / b;
    }
    const bool holds = operation == "<"    ? a < b
                       : operation == "<=" ? a <= b
                       : operation == ">"  ? a > b
                       : operation == ">=" ? a >= b
                       : operation == "="  ? a == b
                                           : a != b;
    return holds ? 1 : 0;
}

} // namespace

/// Turns the text into steps, each after those of what it works on.
class Expression::Parser {
public:
    explicit Parser(std::string_view text) : text_{text} {}

    [[nodiscard]] Expected<Expression, std::string> parse()
    {
        if (text_.size() > max_expression) {
            return Unexpected{std::string{"found an expression of more than 1000 characters"}};
        }
        sum();
        for (const std::string_view sign : {"<=", ">=", "!=", "<", ">", "="}) {
            if (flaw_.empty() && take(sign)) {
                sum();
                add(sign);
                break;
            }
        }
        skip();
        if (flaw_.empty() && !text_.empty()) {
            need("an operator");
        }
        if (!flaw_.empty()) {
            return Unexpected{std::move(flaw_)};
        }
        return std::move(made_);
    }

private:
    void skip() { text_.remove_prefix(std::min(text_.find_first_not_of(' '), text_.size())); }
    [[nodiscard]] bool take(std::string_view sign)
    {
        skip();
        if (!text_.starts_with(sign)) {
            return false;
        }
        text_.remove_prefix(sign.size());
        return true;
    }
    void need(std::string_view what)
    {
        if (flaw_.empty()) {
            flaw_ = "found " +
                    (text_.empty() ? std::string{"the end"} : "\"" + printable(text_) + "\"") +
                    "; expected " + std::string{what};
        }
    }
    void add(std::string_view operation)
    {
        Step& step = made_.steps_.emplace_back();
        step.kind = Step::Kind::Operation;
        step.operation = operation;
    }
    void sum() { chain({"+", "-"}, &Parser::product); }
    void product() { chain({"*", "/"}, &Parser::factor); }
    /// Operands with one of these signs between two, from left to right.
    void chain(std::array<std::string_view, 2> signs, void (Parser::*operand)())
    {
        (this->*operand)();
        for (bool goes_on = true; goes_on && flaw_.empty();) {
            goes_on = false;
            for (const std::string_view sign : signs) {
                if (take(sign)) {
                    (this->*operand)();
                    add(sign);
                    goes_on = true;
                    break;
                }
            }
        }
    }
    void factor()
    {
        std::size_t signs = 0;
        while (take("-")) {
            ++signs;
        }
        if (take("(")) {
            if (++depth_ > max_parentheses) {
                need("at most 50 parentheses within each other");
                return;
            }
            sum();
            --depth_;
            if (!take(")")) {
                need(")");
            }
        } else {
            operand();
        }
        if (signs % 2 == 1) {
            made_.steps_.emplace_back().kind = Step::Kind::Negate;
        }
    }
    void operand()
    {
        skip();
        double number = 0;
        const char* const end = text_.data() + text_.size();
        const auto read = std::from_chars(text_.data(), end, number);
        const bool is_number =
            !text_.empty() && read.ec == std::errc{} && (text_[0] == '.' || text_[0] <= '9');
        std::size_t size = 0;
        while (size < text_.size() && is_name_character(text_[size])) {
            ++size;
        }
        if (is_number) {
            Step& step = made_.steps_.emplace_back();
            step.number = number;
            text_.remove_prefix(static_cast<std::size_t>(read.ptr - text_.data()));
        } else if (size != 0) {
            Step& step = made_.steps_.emplace_back();
            step.kind = Step::Kind::Name;
            step.name = made_.names_.size();
            made_.names_.emplace_back(text_.substr(0, size));
            text_.remove_prefix(size);
        } else {
            need("a number, a name or (");
        }
    }

    std::string_view text_;
    Expression made_;
    std::string flaw_;
    std::size_t depth_{0};
};

Expected<Expression, std::string> Expression::parse(std::string_view text)
{
    return Parser{text}.parse();
}

std::optional<double>
Expression::value(const std::function<std::optional<double>(const std::string&)>& number_of) const
{
    std::vector<double> stack;
    for (const Step& step : steps_) {
        switch (step.kind) {
        case Step::Kind::Number:
            stack.push_back(step.number);
            break;
        case Step::Kind::Name: {
            const auto number = number_of(names_[step.name]);
            if (!number) {
                return std::nullopt;
            }
            stack.push_back(*number);
            break;
        }
        case Step::Kind::Negate:
            stack.back() = -stack.back();
            break;
        case Step::Kind::Operation: {
            const double right = stack.back();
            stack.pop_back();
            stack.back() = operate(step.operation, stack.back(), right);
            break;
        }
        }
    }
    return stack.back();
}

} // namespace busbar::tool
