#include "watched_values.hpp"

#include <algorithm>

#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool {

WatchedValues::WatchedValues(Context& context, Connection& connection, Stream& stream,
                             const FeedSettings& settings, std::vector<FeedNode> nodes,
                             Printing printing)
    : context_{&context}, connection_{&connection}, stream_{&stream}, printing_{printing},
      rows_(nodes.size()),
      feed_{connection,
            stream,
            settings,
            std::move(nodes),
            {[this](std::size_t node, const DataValue& value) { show(node, value); },
             [this](std::size_t node, StatusCode status) { set_status(node, status); }}}
{
}

void WatchedValues::show(std::size_t node, const DataValue& value)
{
    if (!stream_->count()) {
        return;
    }
    ValueRow& row = rows_[node];
    row.value = value;
    const Types types = connection_->types_of({row.value});
    row.shown = full_text_of(row.value, types);
    ++row.changes;
    if (printing_ == Printing::Lines) {
        print(feed_.nodes()[node].text, row, types);
    }
}

void WatchedValues::print(const std::string& node, const ValueRow& row, const Types& types)
{
    if (context_->options.is_json) {
        JsonLine json;
        json.open_object().member("node", node);
        append_json(json, row.value, types);
        context_->out.line(json.close_object().document());
    } else {
        context_->out.line(time_of_day(row.value.source_timestamp) + "  " + safe(node) + "  " +
                           row.shown);
    }
}

void WatchedValues::set_status(std::size_t node, StatusCode status)
{
    ValueRow& row = rows_[node];
    const std::string& text = feed_.nodes()[node].text;
    const bool is_news = row.status != status && status.is_bad();
    row.status = status;
    const auto is_bad = [](const ValueRow& one) { return one.status.is_bad(); };
    if (is_news && std::ranges::all_of(rows_, is_bad)) {
        throw Failure{status, text};
    }
    if (is_news && printing_ == Printing::Lines) {
        context_->err.line("busbar: " + safe(text) + ": " + text_of(status));
    }
}

Exit WatchedValues::exit() const
{
    const auto is_bad = [](const ValueRow& row) { return row.status.is_bad(); };
    return std::ranges::any_of(rows_, is_bad) ? Exit::Partly : Exit::Good;
}

} // namespace busbar::tool
