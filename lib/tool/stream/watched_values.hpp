#pragma once

#include "tool/nodes/node_feed.hpp"
#include "tool/nodes/variable_facts.hpp"
#include "tool/printing/row_format.hpp"

namespace busbar::tool {

/// The state of a node whose values are shown as they change.
struct ValueRow {
    DataValue value;
    std::string shown{"(waiting)"};
    std::uint64_t changes{0};
    StatusCode status;       // of the item
    bool is_answered{false}; // has had a value or a status
};

/// Prints values of nodes as they change, each as a line or a JSON document, unless another
/// listener shows them.
class WatchedValues {
public:
    /// None: only rows() change.
    enum class Printing : std::uint8_t { Lines, None };

    /// Lines are for people, or in JSON, unless `format` is set. Throws Failure.
    WatchedValues(Context& context, Connection& connection, Stream& stream,
                  const FeedSettings& settings, std::vector<FeedNode> nodes, Printing printing,
                  const RowFormat& format);

    [[nodiscard]] NodeFeed& feed() { return feed_; }
    [[nodiscard]] const std::vector<FeedNode>& nodes() const { return feed_.nodes(); }
    [[nodiscard]] const std::vector<ValueRow>& rows() const { return rows_; }
    /// Partly if some of the nodes had no value because their items were refused.
    [[nodiscard]] Exit exit() const;

private:
    void show(std::size_t node, const DataValue& value);
    void print(std::size_t node, const ValueRow& row, const Types& types);
    void set_status(std::size_t node, StatusCode status);
    /// Counts a node of which there is a first value or status.
    void answer(ValueRow& row);

    Context* context_;
    Connection* connection_;
    Stream* stream_;
    Printing printing_;
    RowFormat format_;
    RowWriter writer_;
    std::vector<ValueFacts> facts_;
    std::vector<ValueRow> rows_;
    std::size_t answered_{0};
    NodeFeed feed_;
};

} // namespace busbar::tool
