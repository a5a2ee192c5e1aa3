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

/// Removes the text before `word`, which stands outside of quotes, and the word; all if it is not
/// there.
std::string_view part_before_word(std::string_view& text, std::string_view word)
{
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        is_quoted = is_quoted != (text[i] == '"');
        if (!is_quoted && text.substr(i).starts_with(word)) {
            const std::string_view part = text.substr(0, i);
            text.remove_prefix(i + word.size());
            return part;
        }
    }
    return std::exchange(text, {});
}

std::optional<double> filter_number(std::string_view text)
{
    double number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    return read.ec == std::errc{} && read.ptr == text.data() + text.size() && !text.empty()
               ? std::optional{number}
               : std::nullopt;
}

/// Compares numbers if both are some, after "Double " or the like; else texts.
bool compares(std::string_view found, std::string_view comparison, std::string_view wanted)
{
    if (comparison == "~") {
        return found.find(wanted) != std::string_view::npos;
    }
    const auto a = filter_number(found.substr(found.rfind(' ') + 1)); // npos + 1 is 0
    const auto b = filter_number(wanted.substr(wanted.rfind(' ') + 1));
    const bool are_numbers = a && b;
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
    const bool is_kind = wanted == "Bad" || wanted == "Uncertain";
    return found == wanted || (is_kind && found.starts_with(wanted));
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
    while (!text.empty()) {
        std::string_view choice = part_before_word(text, " or ");
        std::vector<Condition>& conditions = choices_.emplace_back();
        while (!choice.empty()) {
            const std::string_view part = trimmed(part_before_word(choice, " and "));
            const std::size_t sign = std::min(part.find_first_of(comparison_signs), part.size());
            const std::size_t end =
                std::min(part.find_first_not_of(comparison_signs, sign), part.size());
            Condition& condition = conditions.emplace_back();
            condition.name = trimmed(part.substr(0, sign));
            condition.comparison = part.substr(sign, end - sign);
            std::string_view value = trimmed(part.substr(end));
            if (value.size() > 1 && value.front() == '"' && value.back() == '"') {
                value = value.substr(1, value.size() - 2);
            }
            condition.value = value;
            const bool is_known = std::find(comparisons.begin(), comparisons.end(),
                                            condition.comparison) != comparisons.end();
            const bool needs_number = condition.name == "time" || condition.name == "connection" ||
                                      condition.name == "message";
            if (condition.name.empty() || !is_known ||
                (needs_number && !filter_number(condition.value))) {
                throw Failure{Exit::Usage,
                              "--filter: found \"" + std::string{part} +
                                  "\"; expected a name, one of = != < <= > >= ~, and a value",
                              "as in 'service=Read and status!=Good' or 'time>2.5'"};
            }
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
        return std::any_of(message.fields.begin(), message.fields.end(), [&](const auto& field) {
            return is_status(field.text) && has_status(field.text, wanted) != is_unequal;
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
