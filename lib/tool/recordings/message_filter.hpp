#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/harness/recorded_messages.hpp>

namespace busbar::tool {

/// Chooses messages of a recording by an expression:
///
///     service=Read and status!=Good
///     node="ns=1;s=Oven 1" or time>=2.5 and from=server
///     results[0].value~1.5
///
/// - `service`: the name without Request or Response, or the whole of it.
/// - `node`: a NodeId in the request, or in the request that a response answers.
/// - `status`: one of the StatusCodes; Good, Uncertain and Bad stand for all of their kind.
/// - `time` (seconds since the recording began), `connection`, `message`: numbers.
/// - `from`: client or server.
/// - any other name: a field, by the path that --fields shows.
///
/// Comparisons are =, !=, <, <=, >, >= and ~ (contains), of which `node` and `status` have =, !=
/// and ~; `and` binds stronger than `or`. Values are compared as numbers if both are some, else as
/// texts without quotes. A text without any of these is looked for in names and fields.
class MessageFilter {
public:
    /// Throws Failure, which says what was found and what is expected. An empty text chooses all.
    explicit MessageFilter(std::string_view text);

    /// Must be asked about all messages of a recording, in their order.
    [[nodiscard]] bool is_wanted(const harness::RecordedMessage& message);

private:
    struct Condition {
        std::string name;
        std::string comparison;
        std::string value;
    };
    using Nodes = std::set<std::string, std::less<>>;

    void parse(std::string_view text);
    [[nodiscard]] bool holds(const Condition& condition, const harness::RecordedMessage& message,
                             const Nodes& nodes) const;
    [[nodiscard]] const Nodes& nodes_of(const harness::RecordedMessage& message);

    /// One of these holds: all conditions of one.
    std::vector<std::vector<Condition>> choices_;
    std::string contained_;
    /// The nodes in the last request with an id, by connection and id.
    std::map<std::pair<std::uint32_t, std::uint32_t>, Nodes> asked_;
};

} // namespace busbar::tool
