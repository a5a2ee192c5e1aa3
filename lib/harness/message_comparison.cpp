#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include <busbar/harness/recorded_messages.hpp>

#include "recorded_exchanges.hpp"
#include "volatile_fields.hpp"

namespace busbar::harness {

namespace {

/// A request and what came for it.
struct Exchange {
    const RecordedMessage* request{nullptr};
    const RecordedMessage* response{nullptr};
    /// Tells it from others of its name: the number of its content.
    std::size_t content{0};
};

/// The exchanges on all connections, in the order of their requests; errors of the connection
/// protocol stand alone.
std::vector<Exchange> exchanges_of(const std::vector<RecordedMessage>& messages,
                                   std::map<std::string, std::size_t>& contents)
{
    std::vector<Exchange> exchanges;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> open;
    for (const RecordedMessage& message : messages) {
        if (message.name == "ERR") {
            exchanges.push_back({nullptr, &message, 0});
        } else if (message.fields.empty() && !message.name.ends_with("Response")) {
            continue; // the channel's own
        } else if (message.from == Side::Client) {
            open[{message.connection, message.request_id}] = exchanges.size();
            const std::size_t next = contents.size();
            exchanges.push_back(
                {&message, nullptr,
                 contents.try_emplace(detail::content_of(message), next).first->second});
        } else if (const auto found = open.find({message.connection, message.request_id});
                   found != open.end()) {
            exchanges[found->second].response = &message;
            open.erase(found);
        } else {
            exchanges.push_back({nullptr, &message, 0});
        }
    }
    return exchanges;
}

std::string_view name_of(const Exchange& exchange)
{
    return exchange.request != nullptr ? exchange.request->name : exchange.response->name;
}

std::string title_of(const RecordedMessage& message)
{
    const std::string line = summary(message);
    return line.substr(line.find("-> ") + 3);
}

/// Pairs of exchanges that stand for the same; one of both may be missing.
using Pairs = std::vector<std::pair<const Exchange*, const Exchange*>>;

/// The pairs with the least sum of what is missing, new, or of another content.
Pairs align(const std::vector<Exchange>& before, const std::vector<Exchange>& after)
{
    const std::size_t columns = after.size() + 1;
    constexpr std::size_t max_cells = 16'000'000;
    const auto cost_of = [&](std::size_t i, std::size_t j) -> std::uint32_t {
        if (name_of(before[i]) != name_of(after[j])) {
            return 3;
        }
        return before[i].content == after[j].content ? 0 : 1;
    };
    Pairs pairs;
    if ((before.size() + 1) * columns > max_cells) { // one by one
        for (std::size_t i = 0; i < std::max(before.size(), after.size()); ++i) {
            pairs.emplace_back(i < before.size() ? &before[i] : nullptr,
                               i < after.size() ? &after[i] : nullptr);
        }
        return pairs;
    }
    // least[i][j]: the cost of the exchanges from i and from j on.
    std::vector<std::uint32_t> least((before.size() + 1) * columns, 0);
    const auto at = [&](std::size_t i, std::size_t j) -> std::uint32_t& {
        return least[i * columns + j];
    };
    for (std::size_t i = before.size() + 1; i-- > 0;) {
        for (std::size_t j = columns; j-- > 0;) {
            if (i == before.size() || j == after.size()) {
                at(i, j) = static_cast<std::uint32_t>(before.size() - i + after.size() - j);
                continue;
            }
            at(i, j) =
                std::min({at(i + 1, j + 1) + cost_of(i, j), at(i + 1, j) + 1, at(i, j + 1) + 1});
        }
    }
    for (std::size_t i = 0, j = 0; i < before.size() || j < after.size();) {
        if (i < before.size() && j < after.size() && at(i, j) == at(i + 1, j + 1) + cost_of(i, j)) {
            pairs.emplace_back(&before[i++], &after[j++]);
        } else if (i < before.size() && at(i, j) == at(i + 1, j) + 1) {
            pairs.emplace_back(&before[i++], nullptr);
        } else {
            pairs.emplace_back(nullptr, &after[j++]);
        }
    }
    return pairs;
}

/// Returns the number at the end of "Double 1.5" and what is before it.
std::optional<double> number_in(std::string_view text, std::string_view& type)
{
    type = text.substr(0, text.rfind(' ') + 1);
    text.remove_prefix(type.size());
    double number = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
    return end.ec == std::errc{} && end.ptr == text.data() + text.size() ? std::optional{number}
                                                                         : std::nullopt;
}

class Comparison {
public:
    explicit Comparison(const ComparisonOptions& options) : options_{options} {}

    void compare(const Exchange* before, const Exchange* after)
    {
        if (before == nullptr || after == nullptr) {
            const Exchange& only = before != nullptr ? *before : *after;
            const RecordedMessage& message =
                only.request != nullptr ? *only.request : *only.response;
            add((before != nullptr ? "missing: " : "new: ") + title_of(message) + " (message " +
                std::to_string(message.number) + ")");
            return;
        }
        if ((before->request == nullptr) != (after->request == nullptr)) {
            compare(before, nullptr);
            compare(nullptr, after);
            return;
        }
        if (before->request != nullptr) {
            compare(*before->request, *after->request, "");
        }
        const bool has_left =
            name_of(*before) == "CloseSessionRequest"; // the answer is not awaited
        if (has_left && (before->response == nullptr || after->response == nullptr)) {
            return;
        }
        if ((before->response == nullptr) != (after->response == nullptr)) {
            const bool was_there = before->response != nullptr;
            const RecordedMessage& request = was_there ? *after->request : *before->request;
            add((was_there ? "no answer any more to " : "an answer to ") + title_of(request) +
                " (message " + std::to_string(request.number) + ")");
        } else if (before->response != nullptr) {
            compare(*before->response, *after->response, subject_of(*before));
        }
    }
    [[nodiscard]] std::vector<std::string> take()
    {
        if (left_out_ != 0) {
            lines_.push_back(std::to_string(left_out_) + " more");
        }
        return std::move(lines_);
    }

private:
    /// " to ns=1;s=Level".
    static std::string subject_of(const Exchange& exchange)
    {
        if (exchange.request == nullptr) {
            return {};
        }
        const std::string title = title_of(*exchange.request);
        const std::size_t end = title.find(' ');
        return end == std::string::npos ? std::string{} : " to" + title.substr(end);
    }
    void compare(const RecordedMessage& before, const RecordedMessage& after,
                 const std::string& subject);
    void compare_fields(const RecordedMessage& before, const RecordedMessage& after,
                        const std::string& title);
    [[nodiscard]] bool is_same(const RecordedMessage::Field& before,
                               const RecordedMessage::Field& after);
    void add(std::string line)
    {
        if (lines_.size() < options_.max_lines) {
            lines_.push_back(std::move(line));
        } else {
            ++left_out_;
        }
    }

    ComparisonOptions options_;
    std::vector<std::string> lines_;
    std::size_t left_out_{0};
    /// The ids of the second recording by those of the first one, with their kind.
    std::map<std::pair<std::string, std::string>, std::string> ids_;
};

bool Comparison::is_same(const RecordedMessage::Field& before, const RecordedMessage::Field& after)
{
    switch (detail::variability_of(before)) {
    case detail::Variability::Noise:
        return true;
    case detail::Variability::Time:
        if (!options_.with_times) {
            return true;
        }
        break;
    case detail::Variability::Id: {
        const std::string kind{detail::kind_of_id(before.path)};
        return ids_.try_emplace({kind, before.text}, after.text).first->second == after.text;
    }
    case detail::Variability::None:
        break;
    }
    if (before.text == after.text) {
        return true;
    }
    std::string_view type_before;
    std::string_view type_after;
    const auto a = number_in(before.text, type_before);
    const auto b = number_in(after.text, type_after);
    return options_.tolerance > 0 && a && b && type_before == type_after &&
           std::abs(*a - *b) <= options_.tolerance;
}

void Comparison::compare(const RecordedMessage& before, const RecordedMessage& after,
                         const std::string& subject)
{
    const std::string place =
        " (messages " + std::to_string(before.number) + ", " + std::to_string(after.number) + ")";
    if (before.name != after.name) {
        add(before.name + subject + " -> " + title_of(after) + place);
        return;
    }
    const std::size_t first = lines_.size();
    compare_fields(before, after, before.name + subject + ": ");
    for (std::size_t i = first; i < lines_.size(); ++i) {
        lines_[i] += place;
    }
}

void Comparison::compare_fields(const RecordedMessage& before, const RecordedMessage& after,
                                const std::string& title)
{
    const auto is_compared = [&](const RecordedMessage::Field& field) {
        const auto variability = detail::variability_of(field);
        return variability == detail::Variability::None ||
               (variability == detail::Variability::Time && options_.with_times);
    };
    std::map<std::string_view, const RecordedMessage::Field*> only_after;
    for (const RecordedMessage::Field& field : after.fields) {
        only_after.emplace(field.path, &field);
    }
    for (const RecordedMessage::Field& field : before.fields) {
        const auto found = only_after.extract(field.path);
        if (!found.empty()) {
            if (!is_same(field, *found.mapped())) {
                add(title + field.path + " " + field.text + " -> " + found.mapped()->text);
            }
        } else if (is_compared(field)) {
            add(title + field.path + " " + field.text + " -> nothing");
        }
    }
    for (const auto& [path, field] : only_after) {
        if (is_compared(*field)) {
            add(title + field->path + " nothing -> " + field->text);
        }
    }
}

} // namespace

std::vector<std::string> compare_messages(const std::vector<RecordedMessage>& before,
                                          const std::vector<RecordedMessage>& after,
                                          const ComparisonOptions& options)
{
    std::map<std::string, std::size_t> contents;
    const auto first = exchanges_of(before, contents);
    const auto second = exchanges_of(after, contents);
    Comparison comparison{options};
    for (const auto& [a, b] : align(first, second)) {
        comparison.compare(a, b);
    }
    return comparison.take();
}

} // namespace busbar::harness
