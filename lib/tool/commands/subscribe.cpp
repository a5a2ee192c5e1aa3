#include <memory>

#include "commands.hpp"
#include "tool/nodes/nodes.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"
#include "tool/stream/watched_values.hpp"

namespace busbar::tool {

namespace {

struct SubscribeArguments {
    std::vector<std::string> nodes;
    FeedSettings feed;
    StreamEnd end;
    RowFormat format;
};

/// A table that is drawn again at its place for as long as it runs.
class LiveTable {
public:
    explicit LiveTable(Output& out) : out_{&out} {}

    /// At most ten times a second, unless it has to be.
    void draw(const WatchedValues& values, bool is_forced)
    {
        const auto now = std::chrono::steady_clock::now();
        if (!is_forced && now - drawn_ < std::chrono::milliseconds{100}) {
            return;
        }
        drawn_ = now;
        std::vector<std::string> lines = table_of(values).lines(*out_, out_->columns());
        const std::size_t room = std::max<std::size_t>(out_->rows(), 4) - 2;
        if (lines.size() > room) {
            lines.resize(room);
            lines.push_back("... and " + std::to_string(values.rows().size() + 1 - room) + " more");
        }
        std::string picture = shown_ == 0 ? "" : "\x1b[" + std::to_string(shown_) + "A";
        for (const std::string& line : lines) {
            picture += "\x1b[2K" + line + "\n";
        }
        // Erases the rest of the last picture, in case the terminal has become smaller.
        out_->write(picture + "\x1b[J");
        shown_ = lines.size();
    }

private:
    static Table table_of(const WatchedValues& values)
    {
        Table table{
            {{"NODE", 16, false, true}, {"SOURCE TIME", 12}, {"CHANGES", 7, true}, {"VALUE", 20}}};
        for (std::size_t i = 0; i < values.rows().size(); ++i) {
            const ValueRow& row = values.rows()[i];
            const bool is_refused = row.status.is_bad();
            table.add({{safe(values.nodes()[i].text)},
                       {time_of_day(row.value.source_timestamp), Style::Dim},
                       {std::to_string(row.changes)},
                       {is_refused ? text_of(row.status) : row.shown,
                        is_refused ? Style::Bad : style_of(row.value.status)}});
        }
        return table;
    }

    Output* out_;
    std::chrono::steady_clock::time_point drawn_;
    std::size_t shown_{0};
};

Exit show(Context& context, Connection& connection, const SubscribeArguments& arguments)
{
    const bool is_live =
        context.out.is_terminal() && !context.options.is_json && !arguments.format.is_set();
    LiveTable table{context.out};
    Stream stream{context, connection, arguments.end};
    WatchedValues values{context,
                         connection,
                         stream,
                         arguments.feed,
                         parse_feed(arguments.nodes),
                         is_live ? WatchedValues::Printing::None : WatchedValues::Printing::Lines,
                         arguments.format};
    const auto draw = [&](bool is_forced) {
        if (is_live) {
            table.draw(values, is_forced);
        }
    };
    try {
        stream.run([&] { draw(false); });
    } catch (const Interrupted&) {
        draw(true);
        throw;
    }
    draw(true);
    return values.exit();
}

} // namespace

void add_subscribe(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("subscribe", "Shows values as they change, until Ctrl+C.");
    const auto arguments = std::make_shared<SubscribeArguments>();
    command->add_option("NODE", arguments->nodes, "server (optional), then nodes")->required();
    add_feed_options(*command, arguments->feed);
    add_stream_options(*command, arguments->end);
    add_format_options(*command, arguments->format);
    when_chosen(*command, run, [arguments](Context& context) {
        take_url_before(arguments->nodes, context.options);
        check_addresses(arguments->nodes);
        Connection connection{context, Connection::Endurance::Lasting};
        refuse_ambiguous(connection, arguments->nodes);
        return show(context, connection, *arguments);
    });
}

} // namespace busbar::tool
