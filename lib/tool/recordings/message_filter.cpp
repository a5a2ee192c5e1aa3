#include "message_filter.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <optional>

#include "tool/connection/failure.hpp"

namespace busbar::tool {

namespace {

using harness::RecordedMessage;

constexpr std::size_t max_asked = 100'000;
constexpr std::string_view comparison_signs = "=!<>~";
constexpr std::array<std::string_view, 7> comparisons{"=", "!=", "<", "<=", ">", ">=", "~"};

std::string_view trimmed(std::string_view text)
{
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

/// Returns the parts of a text between all `word` that stand outside of quotes; they may be empty.
std::vector<std::string_view> parts_between(std::string_view text, std::string_view word)
{
    std::vector<std::string_view> parts;
    bool is_quoted = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        is_quoted = is_quoted != (text[i] == '"');
        if (!is_quoted && text.substr(i).starts_with(word)) {
            parts.push_back(text.substr(begin, i - begin));
            begin = i + word.size();
            i = begin - 1;
        }
    }
    parts.push_back(text.substr(begin));
    return parts;
}

std::optional<double> filter_number(std::string_view text)
{
    double number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc{} && read.ptr == text.data() + text.size() && !text.empty()
               ? std::optional{number}
               : std::nullopt;
}

/// Returns the number in "1.5" or "Double 1.5"; nothing if the text is another.
std::optional<double> typed_number(std::string_view text)
{
    constexpr std::array<std::string_view, 10> types{"SByte ", "Byte ",   "Int16 ", "UInt16 ",
                                                     "Int32 ", "UInt32 ", "Int64 ", "UInt64 ",
                                                     "Float ", "Double "};
    for (const std::string_view type : types) {
        if (text.starts_with(type)) {
            text.remove_prefix(type.size());
            break;
        }
    }
    return filter_number(text);
}

std::string_view without_quotes(std::string_view text)
{
    const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
    return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// "Oven" of a field's text "Oven" or String "Oven".
std::string_view untyped_text(std::string_view text)
{
    constexpr std::string_view type = "String ";
    if (text.starts_with(type) && text.substr(type.size()).starts_with('"')) {
        text.remove_prefix(type.size());
    }
    return without_quotes(text);
}

/// Compares numbers if both are some; else texts.
bool compares(std::string_view found, std::string_view comparison, std::string_view wanted)
{
    if (comparison == "~") {
        return found.find(wanted) != std::string_view::npos;
    }
    const auto a = typed_number(found);
    const auto b = typed_number(wanted);
    const bool are_numbers = a && b;
    found = untyped_text(found);
    wanted = untyped_text(wanted);
    const bool is_same = are_numbers ? *a == *b : found == wanted;
    if (comparison == "=" || comparison == "!=") {
        return is_same == (comparison == "=");
    }
    const bool is_less = are_numbers ? *a < *b : found < wanted;
    return comparison[0] == '<' ? is_less || (comparison == "<=" && is_same)
                                : !is_less && (comparison == ">=" || !is_same);
}

bool is_status(std::string_view text)
{
    return text == "Good" || text.starts_with("Good_") || text.starts_with("Uncertain") ||
           text.starts_with("Bad");
}

bool has_status(std::string_view found, std::string_view wanted)
{
    const bool is_kind = wanted == "Good" || wanted == "Uncertain" || wanted == "Bad";
    return found == wanted || (is_kind && found.starts_with(wanted));
}

/// Throws Failure unless the condition means something; `part` is its text.
void check_condition(std::string_view part, std::string_view name, std::string_view comparison,
                     std::string_view value)
{
    const bool is_known =
        std::find(comparisons.begin(), comparisons.end(), comparison) != comparisons.end();
    const bool needs_number = name == "time" || name == "connection" || name == "message";
    const bool is_name = !name.empty() && name.find(' ') == std::string_view::npos;
    const std::string found = "--filter: found \"" + std::string{part} + "\"; ";
    if (!is_name || !is_known || (needs_number && !filter_number(value))) {
        throw Failure{Exit::Usage, found + "expected a name, one of = != < <= > >= ~, and a value",
                      "as in 'service=Read and status!=Good' or 'time>2.5'"};
    }
    const bool has_order = name != "status" && name != "node";
    if (!has_order && (comparison[0] == '<' || comparison[0] == '>')) {
        throw Failure{Exit::Usage, found + "expected one of = != ~ after " + std::string{name}};
    }
}

std::string_view service_of(std::string_view name)
{
    for (const std::string_view end : {"Request", "Response"}) {
        if (name.ends_with(end)) {
            return name.substr(0, name.size() - end.size());
        }
    }
    return name;
}

/// The last name of a path, without an index.
std::string_view field_name(std::string_view path)
{
    path.remove_prefix(path.rfind('.') + 1); // npos + 1 is 0
    return path.substr(0, path.find('['));
}

bool is_node(std::string_view path)
{
    const std::string_view name = field_name(path);
    return name == "nodeId" || name.ends_with("NodeId") || name == "objectId" ||
           name == "methodId" || name == "nodesToRegister";
}

} // namespace

MessageFilter::MessageFilter(std::string_view text)
{
    if (text.find_first_of(comparison_signs) == std::string_view::npos) {
        contained_ = text;
    } else {
        parse(text);
    }
}

void MessageFilter::parse(std::string_view text)
{
    for (const std::string_view choice : parts_between(text, " or ")) {
        std::vector<Condition>& conditions = choices_.emplace_back();
        for (const std::string_view whole : parts_between(choice, " and ")) {
            const std::string_view part = trimmed(whole);
            const std::size_t sign = std::min(part.find_first_of(comparison_signs), part.size());
            const std::size_t end =
                std::min(part.find_first_not_of(comparison_signs, sign), part.size());
            Condition& condition = conditions.emplace_back();
            condition.name = trimmed(part.substr(0, sign));
            condition.comparison = part.substr(sign, end - sign);
            condition.value = without_quotes(trimmed(part.substr(end)));
            check_condition(part, condition.name, condition.comparison, condition.value);
        }
    }
}

const MessageFilter::Nodes& MessageFilter::nodes_of(const RecordedMessage& message)
{
    const std::pair place{message.connection, message.request_id};
    if (message.from == harness::Side::Client) {
        if (asked_.size() >= max_asked) {
            asked_.erase(asked_.begin());
        }
        Nodes& nodes = asked_[place];
        nodes.clear();
        for (const RecordedMessage::Field& field : message.fields) {
            if (is_node(field.path)) {
                nodes.insert(field.text);
            }
        }
        return nodes;
    }
    static const Nodes none;
    const auto found = asked_.find(place);
    return found == asked_.end() ? none : found->second;
}

bool MessageFilter::holds(const Condition& condition, const RecordedMessage& message,
                          const Nodes& nodes) const
{
    const std::string_view wanted = condition.value;
    const auto is_it = [&](std::string_view found) {
        return compares(found, condition.comparison, wanted);
    };
    const bool is_unequal = condition.comparison == "!=";
    if (condition.name == "service") {
        const bool is_whole = service_of(wanted) != wanted;
        return is_it(is_whole ? std::string_view{message.name} : service_of(message.name));
    }
    if (condition.name == "node") {
        const bool has_it = std::any_of(nodes.begin(), nodes.end(), [&](const std::string& node) {
            return condition.comparison == "~" ? node.find(wanted) != std::string::npos
                                               : node == wanted;
        });
        return has_it != is_unequal;
    }
    if (condition.name == "status") {
        const bool contains = condition.comparison == "~";
        return std::any_of(message.fields.begin(), message.fields.end(), [&](const auto& field) {
            const bool is_it = contains ? field.text.find(wanted) != std::string::npos
                                        : has_status(field.text, wanted);
            return is_status(field.text) && is_it != is_unequal;
        });
    }
    if (condition.name == "from") {
        return is_it(message.from == harness::Side::Client ? "client" : "server");
    }
    if (condition.name == "time") {
        return is_it(std::to_string(std::chrono::duration<double>{message.time}.count()));
    }
    if (condition.name == "connection") {
        return is_it(std::to_string(message.connection));
    }
    if (condition.name == "message") {
        return is_it(std::to_string(message.number));
    }
    return std::any_of(message.fields.begin(), message.fields.end(), [&](const auto& field) {
        return field.path == condition.name && is_it(field.text);
    });
}

bool MessageFilter::is_wanted(const RecordedMessage& message)
{
    if (choices_.empty()) {
        return message.name.find(contained_) != std::string::npos ||
               std::any_of(message.fields.begin(), message.fields.end(), [&](const auto& field) {
                   return (field.path + " " + field.text).find(contained_) != std::string::npos;
               });
    }
    const Nodes& nodes = nodes_of(message);
    return std::any_of(choices_.begin(), choices_.end(), [&](const auto& conditions) {
        return std::all_of(conditions.begin(), conditions.end(), [&](const Condition& condition) {
            return holds(condition, message, nodes);
        });
    });
}

} // namespace busbar::tool
