#pragma once

#include <memory>

#include "live_writer.hpp"
#include "model.hpp"
#include "terminal.hpp"
#include "tool/nodes/node_feed.hpp"
#include "tool/nodes/variable_facts.hpp"

namespace busbar::tool::watch {

/// A Variable that is watched.
struct Watched {
    FeedNode node;
    /// Its name in the table.
    std::string name;
    ValueFacts facts{};
};

struct ViewSettings {
    FeedSettings feed;
    StreamEnd end;
    bool has_events{true};
    /// A note for the user at the start; may be empty.
    std::string note;
    /// The folder that all names are below; may be empty.
    std::string folder;
};

/// The live view: brings together what the server sends, what the user types, the model of both and
/// the terminal.
class View {
public:
    /// Throws Failure.
    View(Context& context, Connection& connection, const ViewSettings& settings,
         const std::vector<Watched>& nodes, std::unique_ptr<Terminal> terminal);
    View(const View&) = delete;
    View& operator=(const View&) = delete;
    ~View() = default;

    /// Until the user quits, or the terminal is gone: HungUp. Partly if items were refused.
    Exit run();

private:
    class Listener;

    void show_value(std::size_t row, const DataValue& value);
    void learn_types(std::size_t row, const DataValue& value);
    void show_event(const Array<Variant>& fields);
    void show_events_status(StatusCode status);
    void set_connected();

    void take_keys();
    void take_key(const Key& key);
    void edit(const Key& key);
    void act(Action action);
    [[nodiscard]] std::string told(std::size_t row, const DataValue& value);
    void begin_write();
    void write(const std::string& text);
    void draw();

    Context* context_;
    Connection* connection_;
    std::vector<Watched> nodes_;
    Model model_;
    /// Version of the newest value of each row: types may arrive after the next value.
    std::vector<std::uint64_t> versions_;
    std::vector<StatusCode> statuses_; // of the items
    TimePoint drawn_;
    bool is_changed_{true};
    std::size_t writing_{0};
    Stream stream_;
    NodeFeed feed_;
    LiveWriter writer_;
    /// The first to go, so that the user is not kept waiting in it.
    std::unique_ptr<Terminal> terminal_;
};

/// Security and user of the connection: "Basic256Sha256 SignAndEncrypt, operator".
[[nodiscard]] std::string security_text(const EndpointDescription* endpoint,
                                        const Options& options);

} // namespace busbar::tool::watch
