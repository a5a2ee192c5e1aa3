#include <memory>
#include <unordered_map>

#include "commands.hpp"
#include "display_text.hpp"
#include "nodes.hpp"
#include "stream.hpp"
#include "table.hpp"
#include "value.hpp"

namespace busbar::cli {

namespace {

struct Arguments {
    std::vector<std::string> nodes;
    double interval{500}; // milliseconds
    double sampling{-1};
    std::uint32_t queue_size{10};
    StreamEnd end;
};

/// What is known of one node.
struct Row {
    std::string text;
    DataValue value;
    std::string shown;
    std::uint64_t changes{0};
    StatusCode status; // of the item
};

/// A table that is drawn again at its place for as long as it runs.
class LiveTable {
public:
    explicit LiveTable(Output& out) : out_{&out} {}

    /// At most ten times a second, unless it has to be.
    void draw(const std::vector<Row>& rows, bool is_forced)
    {
        const auto now = std::chrono::steady_clock::now();
        if (!is_forced && now - drawn_ < std::chrono::milliseconds{100}) {
            return;
        }
        drawn_ = now;
        std::vector<std::string> lines = table_of(rows).lines(*out_, out_->columns());
        const std::size_t room = std::max<std::size_t>(out_->rows(), 4) - 2;
        if (lines.size() > room) {
            lines.resize(room);
            lines.push_back("... and " + std::to_string(rows.size() + 1 - room) + " more");
        }
        std::string picture = shown_ == 0 ? "" : "\x1b[" + std::to_string(shown_) + "A";
        for (const std::string& line : lines) {
            picture += "\x1b[2K" + line + "\n";
        }
        // What the last picture had more, if the terminal became smaller meanwhile.
        out_->write(picture + "\x1b[J");
        shown_ = lines.size();
    }

private:
    static Table table_of(const std::vector<Row>& rows)
    {
        Table table{
            {{"NODE", 16, false, true}, {"SOURCE TIME", 12}, {"CHANGES", 7, true}, {"VALUE", 20}}};
        for (const Row& row : rows) {
            const bool is_refused = row.status.is_bad();
            table.add({{safe(row.text)},
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

/// Subscribes to the nodes, and shows each change as a line or all of them as a live table.
class Subscriber {
public:
    Subscriber(Context& context, Connection& connection, const Arguments& arguments)
        : context_{&context}, connection_{&connection}, is_live_{context.out.is_terminal() &&
                                                                 !context.options.is_json},
          live_{context.out}, stream_{context, connection, arguments.end}
    {
        subscribe(arguments);
    }

    Exit run()
    {
        try {
            stream_.run([this] { draw(false); });
        } catch (const Interrupted&) {
            draw(true);
            throw;
        }
        draw(true);
        const auto bad = std::count_if(rows_.begin(), rows_.end(),
                                       [](const Row& row) { return row.status.is_bad(); });
        return bad == 0 ? Exit::Good : Exit::Partly;
    }

private:
    void draw(bool is_forced)
    {
        if (is_live_) {
            live_.draw(rows_, is_forced);
        }
    }
    void subscribe(const Arguments& arguments)
    {
        client::SubscriptionSettings settings;
        settings.publishing_interval = decltype(settings.publishing_interval){arguments.interval};
        auto handlers = stream_.handlers(
            [this](client::ItemHandle item) { return rows_[row_of_.at(item)].text; });
        handlers.on_data = [this](std::span<const client::DataChange> changes) { take(changes); };
        handlers.on_item = [this](client::ItemHandle item, const client::ItemStatus& status) {
            stream_.push([this, item, code = status.status] { set_status(item, code); });
        };
        auto& subscriptions = connection_->client().subscriptions();
        const auto subscription = connection_->value(
            subscriptions.create(settings, std::move(handlers)), "the subscription");
        std::vector<client::ItemSettings> items;
        for (const std::string& node : arguments.nodes) {
            client::ItemSettings& item = items.emplace_back();
            item.node = parse_address(node);
            item.sampling_interval = decltype(item.sampling_interval){arguments.sampling};
            item.queue_size = arguments.queue_size;
            rows_.push_back({node, {}, "(waiting)", 0, {}});
        }
        const auto handles = connection_->value(
            subscriptions.add_items(subscription, std::move(items)), "the monitored items");
        for (std::size_t i = 0; i < handles.size(); ++i) {
            row_of_.emplace(handles[i], i);
        }
    }
    void take(std::span<const client::DataChange> changes)
    {
        for (const client::DataChange& change : changes) {
            stream_.push([this, change] { show(change); });
        }
    }
    void show(const client::DataChange& change)
    {
        if (!stream_.count()) {
            return;
        }
        Row& row = rows_[row_of_.at(change.item)];
        row.value = change.value;
        const Types types = connection_->types_of({row.value});
        row.shown = text_of(row.value, types);
        ++row.changes;
        if (context_->options.is_json) {
            JsonWriter json;
            json.open_object().member("node", row.text);
            append_json(json, row.value, types);
            context_->out.line(json.close_object().document());
        } else if (!is_live_) {
            context_->out.line(time_of_day(row.value.source_timestamp) + "  " + safe(row.text) +
                               "  " + row.shown);
        }
    }
    void set_status(client::ItemHandle item, StatusCode status)
    {
        Row& row = rows_[row_of_.at(item)];
        const bool is_news = row.status != status && status.is_bad();
        row.status = status;
        const auto is_bad = [](const Row& one) { return one.status.is_bad(); };
        if (is_news && std::all_of(rows_.begin(), rows_.end(), is_bad)) {
            throw Failure{status, row.text};
        }
        if (is_news && !is_live_) {
            context_->err.line("busbar: " + safe(row.text) + ": " + text_of(status));
        }
    }

    Context* context_;
    Connection* connection_;
    bool is_live_;
    LiveTable live_;
    std::vector<Row> rows_;
    std::unordered_map<client::ItemHandle, std::size_t> row_of_;
    Stream stream_;
};

} // namespace

void add_subscribe(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("subscribe", "Shows values as they change, until Ctrl+C.");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("NODE", arguments->nodes, "[URL] and nodes")->required();
    command->add_option("-i,--interval", arguments->interval, "publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command->add_option("--sampling", arguments->sampling, "-1 for the publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command->add_option("--queue", arguments->queue_size, "values kept between two publishings")
        ->type_name("N")
        ->capture_default_str();
    add_stream_options(*command, arguments->end);
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            take_url_before(arguments->nodes, context.options);
            check_addresses(arguments->nodes);
            Connection connection{context, Connection::Endurance::Lasting};
            return Subscriber{context, connection, *arguments}.run();
        };
    });
}

} // namespace busbar::cli
