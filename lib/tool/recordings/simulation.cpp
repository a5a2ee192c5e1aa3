#include "simulation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <type_traits>

#include <busbar/client/value_text.hpp>
#include <busbar/core/built_in_type.hpp>
#include <busbar/core/text.hpp>

#include "core/visit_built_in.hpp"

namespace busbar::tool {

namespace {

constexpr std::size_t max_variables = 10'000;
constexpr std::size_t max_values = 1'000;

std::optional<BuiltInType> type_of(std::string_view text)
{
    for (std::uint8_t i = 1; i <= last_built_in_type; ++i) {
        if (name(BuiltInType{i}) == text) {
            return BuiltInType{i};
        }
    }
    return std::nullopt;
}

std::optional<Duration> period_of(std::string_view text)
{
    double number = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit = text.substr(static_cast<std::size_t>(end.ptr - text.data()));
    const double seconds = unit == "ms" ? number / 1'000 : unit == "s" ? number : number * 60;
    constexpr double most = 86'400;
    if (end.ec != std::errc{} || (unit != "ms" && unit != "s" && unit != "min") ||
        !(seconds >= 0.01 && seconds <= most)) {
        return std::nullopt;
    }
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>{seconds});
}

/// Reads one line, which has words.
class LineReader {
public:
    explicit LineReader(std::vector<std::string> words) : words_{std::move(words)} {}

    [[nodiscard]] Expected<SimulatedVariable, std::string> read()
    {
        SimulatedVariable variable;
        variable.name = words_[0];
        if (words_.size() < 3) {
            return Unexpected{std::string{"found " + std::to_string(words_.size()) +
                                          " words; expected NAME TYPE and a value or a signal"}};
        }
        const auto type = type_of(words_[1]);
        if (!type) {
            return Unexpected{"found the type \"" + printable(words_[1]) +
                              "\"; expected a built-in type, as Double, Int32, Boolean or String"};
        }
        type_ = *type;
        if (words_.back() == "write") {
            variable.is_writable = true;
            words_.pop_back();
        }
        if (auto flaw = read_signal(variable.signal); !flaw.empty()) {
            return Unexpected{std::move(flaw)};
        }
        return variable;
    }

private:
    [[nodiscard]] std::string read_signal(SimulatedSignal& signal)
    {
        const std::string& kind = words_.size() > 2 ? words_[2] : words_[1];
        const bool is_ramp = kind == "ramp";
        const bool is_sine = kind == "sine";
        if (!is_ramp && !is_sine && kind != "steps") {
            if (words_.size() != 3) {
                return "found " + std::to_string(words_.size() - 2) +
                       " words after the type; expected one value, or ramp, sine or steps";
            }
            return add(signal, words_[2]);
        }
        signal.kind = is_ramp   ? SimulatedSignal::Kind::Ramp
                      : is_sine ? SimulatedSignal::Kind::Sine
                                : SimulatedSignal::Kind::Steps;
        const std::size_t count = words_.size() - 3;
        if (kind == "steps" ? count < 2 || count > max_values : count != 3) {
            return kind == "steps"
                       ? "expected steps, 1 to 1000 values and a period, as steps 1 2 3 5s"
                       : "expected " + kind + ", two numbers and a period, as " + kind +
                             " 0 100 60s";
        }
        const auto period = period_of(words_.back());
        if (!period) {
            return "found the period \"" + printable(words_.back()) +
                   "\"; expected 10ms to 1440min, as 500ms, 5s or 2min";
        }
        signal.period = *period;
        for (std::size_t i = 3; i + 1 < words_.size(); ++i) {
            if (auto flaw = add(signal, words_[i]); !flaw.empty()) {
                return flaw;
            }
        }
        if (kind != "steps" && !number_in(signal.values[0])) {
            return kind + " is for numbers, and not for " + std::string{name(type_)};
        }
        return {};
    }
    [[nodiscard]] std::string add(SimulatedSignal& signal, const std::string& text) const
    {
        client::ValueType type;
        type.built_in = type_;
        auto value = client::parse_value(text, type);
        if (!value) {
            return value.error().message;
        }
        signal.values.push_back(*std::move(value));
        return {};
    }

    std::vector<std::string> words_;
    BuiltInType type_{BuiltInType::Double};
};

/// Reads the rest of a line that begins with "method" or "event".
class ExtraReader {
public:
    explicit ExtraReader(std::vector<std::string> words) : words_{std::move(words)} {}

    [[nodiscard]] Expected<SimulatedMethod, std::string> read_method()
    {
        SimulatedMethod method;
        method.name = next("the name of a Method");
        while (flaw_.empty() && at_ < words_.size()) {
            const std::string part = next("in, out or sets");
            const std::size_t before = at_;
            while (flaw_.empty() && at_ < words_.size() && !is_part(words_[at_])) {
                if (part == "in") {
                    method.inputs.push_back(argument());
                } else if (part == "out") {
                    method.outputs.push_back(answer(method));
                } else if (part == "sets") {
                    std::string variable = next("a Variable");
                    method.settings.push_back({std::move(variable), expression()});
                } else {
                    say("found \"" + printable(part) + "\"; expected in, out or sets");
                }
            }
            if (at_ == before) {
                say("found nothing after \"" + printable(part) + "\"");
            }
        }
        if (!flaw_.empty()) {
            return Unexpected{std::move(flaw_)};
        }
        return method;
    }
    [[nodiscard]] Expected<SimulatedEvent, std::string> read_event()
    {
        SimulatedEvent event;
        event.message = next("a message");
        const std::string severity = next("a severity");
        const char* const end = severity.data() + severity.size();
        const auto read = std::from_chars(severity.data(), end, event.severity);
        if (read.ec != std::errc{} || read.ptr != end || event.severity < 1 ||
            event.severity > 1'000) {
            say("found the severity \"" + printable(severity) + "\"; expected 1 to 1000");
        }
        const std::string kind = next("when or every");
        if (kind == "when") {
            event.condition = expression();
        } else if (kind == "every") {
            const std::string text = next("a period");
            const auto period = period_of(text);
            if (!period) {
                say("found the period \"" + printable(text) +
                    "\"; expected 10ms to 1440min, as 500ms, 5s or 2min");
            }
            event.period = period.value_or(Duration{0});
        } else {
            say("found \"" + printable(kind) + "\"; expected when or every");
        }
        if (at_ != words_.size()) {
            say("found \"" + printable(words_[std::min(at_, words_.size() - 1)]) +
                "\"; expected the end of the line");
        }
        if (!flaw_.empty()) {
            return Unexpected{std::move(flaw_)};
        }
        return event;
    }

private:
    static bool is_part(std::string_view word)
    {
        return word == "in" || word == "out" || word == "sets";
    }
    /// Keeps what went wrong first.
    void say(std::string flaw)
    {
        if (flaw_.empty()) {
            flaw_ = std::move(flaw);
        }
    }
    [[nodiscard]] std::string next(std::string_view what)
    {
        if (at_ == words_.size()) {
            say("found the end; expected " + std::string{what});
            return {};
        }
        return words_[at_++];
    }
    [[nodiscard]] SimulatedArgument argument()
    {
        SimulatedArgument made;
        made.name = next("the name of an argument");
        const std::string text = next("a type");
        const auto type = type_of(text);
        if (!type) {
            say("found the type \"" + printable(text) +
                "\"; expected a built-in type, as Double, Int32, Boolean or String");
        }
        made.type = type.value_or(made.type);
        return made;
    }
    [[nodiscard]] SimulatedAnswer answer(const SimulatedMethod& method)
    {
        SimulatedAnswer made;
        made.argument = argument();
        const std::string text = next("an input, a value or an expression");
        for (std::size_t i = 0; i < method.inputs.size(); ++i) {
            if (method.inputs[i].name == text && method.inputs[i].type == made.argument.type) {
                made.input = i;
                return made;
            }
        }
        client::ValueType type;
        type.built_in = made.argument.type;
        if (auto value = client::parse_value(text, type)) {
            made.value = *std::move(value);
        } else if (number_in(null_of(made.argument.type))) {
            auto read = Expression::parse(text);
            if (read) {
                made.expression = *std::move(read);
            } else {
                say(std::move(read.error()));
            }
        } else {
            say(value.error().message);
        }
        return made;
    }
    [[nodiscard]] Expression expression()
    {
        auto read = Expression::parse(next("an expression"));
        if (!read) {
            say(std::move(read.error()));
            return *Expression::parse("0");
        }
        return *std::move(read);
    }

    std::vector<std::string> words_;
    std::size_t at_{1};
    std::string flaw_;
};

/// Returns the name in one of the machine's expressions that stands for nothing; empty if all do.
std::string unknown_name(const SimulatedMachine& machine)
{
    std::set<std::string, std::less<>> variables;
    for (const SimulatedVariable& variable : machine.variables) {
        variables.insert(variable.name);
    }
    std::string unknown;
    const auto check = [&](const Expression& expression,
                           const std::vector<SimulatedArgument>& inputs) {
        for (const std::string& name : expression.names()) {
            const bool is_input = std::any_of(inputs.begin(), inputs.end(), [&](const auto& input) {
                return input.name == name;
            });
            if (!is_input && !variables.contains(name)) {
                unknown = name;
            }
        }
    };
    for (const SimulatedMethod& method : machine.methods) {
        for (const SimulatedAnswer& answer : method.outputs) {
            if (answer.expression) {
                check(*answer.expression, method.inputs);
            }
        }
        for (const SimulatedMethod::Setting& setting : method.settings) {
            check(setting.expression, method.inputs);
            if (!variables.contains(setting.variable)) {
                unknown = setting.variable;
            }
        }
    }
    for (const SimulatedEvent& event : machine.events) {
        if (event.condition) {
            check(*event.condition, {});
        }
    }
    return unknown;
}

} // namespace

std::optional<double> number_in(const Variant& value)
{
    return busbar::detail::visit_built_in(value.type(), [&](auto tag) -> std::optional<double> {
        using T = typename decltype(tag)::type;
        if constexpr (std::is_arithmetic_v<T>) {
            if (const T* const found = value.get_if<T>()) {
                return static_cast<double>(*found);
            }
        }
        return std::nullopt;
    });
}

namespace {

/// Beyond the type it is the nearest one, or nothing.
enum class Beyond : std::uint8_t { Nearest, Nothing };

/// Returns the number as a T; empty for what is not a number, unless T has that.
template <typename T>
Variant number_as(double number, Beyond beyond)
{
    using Limits = std::numeric_limits<T>;
    if constexpr (std::is_same_v<T, bool>) {
        return std::isnan(number) ? Variant{} : Variant{number != 0};
    } else if constexpr (std::is_floating_point_v<T>) {
        const bool fits =
            !std::isfinite(number) || std::fabs(number) <= static_cast<double>(Limits::max());
        return fits ? Variant{static_cast<T>(number)}
               : beyond == Beyond::Nearest
                   ? Variant{std::copysign(Limits::max(), static_cast<T>(number < 0 ? -1 : 1))}
                   : Variant{};
    } else {
        // The limit above is a power of two, which a double has; that of 64 bits itself it has not.
        const double rounded = std::round(number);
        const bool is_below = rounded < static_cast<double>(Limits::min());
        const bool is_above = rounded >= std::ldexp(1.0, Limits::digits);
        if (std::isnan(number) || ((is_below || is_above) && beyond == Beyond::Nothing)) {
            return {};
        }
        return is_below   ? Variant{Limits::min()}
               : is_above ? Variant{Limits::max()}
                          : Variant{static_cast<T>(rounded)};
    }
}

Variant made_like(const Variant& model, double number, Beyond beyond)
{
    return busbar::detail::visit_built_in(model.type(), [&](auto tag) -> Variant {
        using T = typename decltype(tag)::type;
        if constexpr (std::is_arithmetic_v<T>) {
            if (model.get_if<T>() != nullptr) {
                return number_as<T>(number, beyond);
            }
        }
        return {};
    });
}

} // namespace

Variant number_like(const Variant& model, double number)
{
    return made_like(model, number, Beyond::Nothing);
}

std::vector<std::string> simulation_words(std::string_view line)
{
    std::vector<std::string> words;
    for (std::size_t at = 0; at < line.size();) {
        if (line[at] == ' ' || line[at] == '\t' || line[at] == '\r') {
            ++at;
            continue;
        }
        const bool is_quoted = line[at] == '"';
        const std::size_t begin = is_quoted ? at + 1 : at;
        const std::size_t end = std::min(
            is_quoted ? line.find('"', begin) : line.find_first_of(" \t\r", begin), line.size());
        words.emplace_back(line.substr(begin, end - begin));
        at = end + 1;
    }
    return words;
}

Variant null_of(BuiltInType type)
{
    client::ValueType wanted;
    wanted.built_in = type;
    for (const char* const text : {"0", "false", ""}) {
        if (auto value = client::parse_value(text, wanted)) {
            return *std::move(value);
        }
    }
    return {};
}

Variant SimulatedSignal::at(Duration time) const
{
    if (kind == Kind::Constant) {
        return values[0];
    }
    const double periods = std::chrono::duration<double>{time} / period;
    if (kind == Kind::Steps) {
        return values[static_cast<std::size_t>(
            std::fmod(std::floor(periods), static_cast<double>(values.size())))];
    }
    const double first = number_in(values[0]).value_or(0);
    const double second = number_in(values[1]).value_or(0);
    const double part = periods - std::floor(periods);
    return made_like(values[0],
                     kind == Kind::Ramp ? first + (second - first) * part
                                        : first + second * std::sin(2 * std::numbers::pi * part),
                     Beyond::Nearest);
}

Configured<SimulatedMachine> read_simulation(std::string_view text, std::string_view file)
{
    SimulatedMachine machine;
    std::set<std::string> names;
    std::size_t number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        ++number;
        auto words = simulation_words(line);
        if (words.empty() || words[0].starts_with('#')) {
            continue;
        }
        const std::string where = std::string{file} + ":" + std::to_string(number);
        const std::string kind = words[0];
        std::string name;
        if (kind == "method") {
            auto method = ExtraReader{std::move(words)}.read_method();
            if (!method) {
                return misconfigured(where, std::move(method.error()));
            }
            name = method->name;
            machine.methods.push_back(*std::move(method));
        } else if (kind == "event") {
            auto event = ExtraReader{std::move(words)}.read_event();
            if (!event) {
                return misconfigured(where, std::move(event.error()));
            }
            machine.events.push_back(*std::move(event));
            name = where; // messages may be the same
        } else {
            auto variable = LineReader{std::move(words)}.read();
            if (!variable) {
                return misconfigured(where, std::move(variable.error()));
            }
            name = variable->name;
            machine.variables.push_back(*std::move(variable));
        }
        if (!names.insert(name).second) {
            return misconfigured(where, printable(name) + " is there twice");
        }
        if (names.size() > max_variables) {
            return misconfigured(where, "there are more than 10000 lines");
        }
    }
    if (machine.variables.empty() && machine.methods.empty()) {
        return misconfigured(std::string{file}, "found no variable; expected lines as "
                                                "\"Level Double ramp 0 100 60s\"");
    }
    if (const std::string name = unknown_name(machine); !name.empty()) {
        return misconfigured(std::string{file}, "found \"" + printable(name) +
                                                    "\" in an expression; expected an input or a "
                                                    "variable");
    }
    return machine;
}

} // namespace busbar::tool
