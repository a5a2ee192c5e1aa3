#include "watched_values.hpp"

#include <algorithm>

#include <busbar/core/status_codes.hpp>

#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

WatchedValues::WatchedValues(Context& context, Connection& connection, Stream& stream,
                             const FeedSettings& settings, std::vector<FeedNode> nodes,
                             Printing printing, const RowFormat& format)
    : context_{&context}, connection_{&connection}, stream_{&stream}, printing_{printing},
      format_{format}, writer_{context.out, format},
      facts_{facts_of(connection, find_nodes(connection, texts_of(nodes)), FactsWanted::All)},
      rows_(nodes.size()),
      feed_{connection,
            stream,
            settings,
            std::move(nodes),
            {[this](std::size_t node, const DataValue& value) { show(node, value); },
             [this](std::size_t node, StatusCode status) { set_status(node, status); }}}
{
    // Which items are refused has to be known first.
    stream.end_after([this] { return answered_ == rows_.size(); });
}

void WatchedValues::answer(ValueRow& row)
{
    answered_ += row.is_answered ? 0 : 1;
    row.is_answered = true;
}

void WatchedValues::show(std::size_t node, const DataValue& value)
{
    ValueRow& row = rows_[node];
    answer(row);
    if (!stream_->count()) {
        return;
    }
    row.value = value;
    const client::NodeAddress& address = feed_.nodes()[node].address;
    const Types types = connection_->types_of(
        {row.value}, {address.node_id(connection_->client().server()).value_or(NodeId{})});
    row.shown = full_text_of(row.value, types, {facts_[node].data_type});
    if (!facts_[node].unit.empty() && !row.value.status.is_bad()) {
        row.shown += " " + facts_[node].unit;
    }
    ++row.changes;
    if (printing_ == Printing::Lines) {
        print(node, row, types);
    }
}

void WatchedValues::print(std::size_t node, const ValueRow& row, const Types& types)
{
    const std::string& text = feed_.nodes()[node].text;
    if (format_.is_set()) {
        writer_.write({text, &row.value, facts_[node].data_type, facts_[node].unit}, types);
    } else if (context_->options.is_json) {
        JsonLine json;
        json.open_object().member("node", text);
        append_json(json, row.value, types, facts_[node].data_type);
        context_->out.line(json.close_object().document());
    } else {
        context_->out.line(time_of_day(row.value.source_timestamp) + "  " + safe(text) + "  " +
                           row.shown);
    }
}

void WatchedValues::set_status(std::size_t node, StatusCode status)
{
    ValueRow& row = rows_[node];
    answer(row);
    const std::string& text = feed_.nodes()[node].text;
    const bool is_news = row.status != status && status.is_bad();
    row.status = status;
    const auto is_bad = [](const ValueRow& one) { return one.status.is_bad(); };
    if (is_news && std::ranges::all_of(rows_, is_bad)) {
        throw value_failure({text, NodeId{}}, status, facts_[node]);
    }
    if (is_news && printing_ == Printing::Lines) {
        const std::string reason = status == status::Bad_AttributeIdInvalid
                                       ? reason_of_no_value(facts_[node])
                                       : std::string{};
        context_->err.line("busbar: " + safe(text) + ": " + text_of(status) +
                           (reason.empty() ? "" : ", " + reason));
    }
}

Exit WatchedValues::exit() const
{
    const auto is_bad = [](const ValueRow& row) { return row.status.is_bad(); };
    return std::ranges::any_of(rows_, is_bad) ? Exit::Partly : Exit::Good;
}

} // namespace busbar::tool
