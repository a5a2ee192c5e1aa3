#include "view.hpp"

#include <algorithm>

#include <unistd.h>

#include <busbar/net/system.hpp>
#include <busbar/types/ids.hpp>

#include "render.hpp"
#include "tool/connection/failure.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/stream/event_stream.hpp"

namespace busbar::tool::watch {

namespace {

/// A picture is not drawn more often than the first, nor less often than the second: ages grow.
constexpr auto shortest_between_pictures = std::chrono::milliseconds{50};
constexpr auto longest_between_pictures = std::chrono::milliseconds{250};

Now now()
{
    return {std::chrono::steady_clock::now(), net::SystemWallClock{}.now()};
}

std::size_t count_bad(const std::vector<StatusCode>& statuses)
{
    return static_cast<std::size_t>(
        std::ranges::count_if(statuses, [](StatusCode status) { return status.is_bad(); }));
}

std::vector<FeedNode> feed_of(const std::vector<Watched>& nodes)
{
    std::vector<FeedNode> feed;
    feed.reserve(nodes.size());
    for (const Watched& watched : nodes) {
        feed.push_back(watched.node);
    }
    return feed;
}

} // namespace

/// Tells the model what the connection does.
class View::Listener final : public StreamListener {
public:
    explicit Listener(View& view) : view_{&view} {}

    void lost(StatusCode why) override
    {
        view_->model_.link().lost(why, now());
        view_->is_changed_ = true;
    }
    void back() override { view_->set_connected(); }
    void missed(const client::Gap& gap) override
    {
        view_->model_.link().missed(gap.from, gap.to, gap.reason);
        view_->is_changed_ = true;
    }
    void polling() override
    {
        view_->model_.tell("the server has no subscriptions: values are read instead");
    }

private:
    View* view_;
};

View::View(Context& context, Connection& connection, const ViewSettings& settings,
           const std::vector<Watched>& nodes, std::unique_ptr<Terminal> terminal)
    : context_{&context}, connection_{&connection}, nodes_{nodes},
      model_{safe(context.options.url) +
             (settings.folder.empty() ? "" : "  " + safe(settings.folder))},
      versions_(nodes.size()), statuses_(nodes.size()), stream_{context, connection, settings.end,
                                                                std::make_unique<Listener>(*this)},
      feed_{connection,
            stream_,
            settings.feed,
            feed_of(nodes),
            {[this](std::size_t row, const DataValue& value) { show_value(row, value); },
             [this](std::size_t row, StatusCode status) {
                 statuses_[row] = status;
                 model_.set_item(row, status);
                 is_changed_ = true;
             }}},
      writer_{connection, stream_}, terminal_{std::move(terminal)}
{
    for (const Watched& watched : nodes_) {
        model_.add_row(safe(watched.name));
    }
    if (settings.has_events) {
        feed_.add_events(
            event_item(NodeId{0, id::Server}),
            [this](const Array<Variant>& fields) { show_event(fields); },
            [this](StatusCode status) { show_events_status(status); });
    } else {
        model_.apply(Action::Events, now());
    }
    model_.tell(settings.note, Style::Uncertain);
    set_connected();
    stream_.wake_on(STDIN_FILENO);
    connection.end_at_hangup();
}

Exit View::run()
{
    draw();
    try {
        stream_.run([this] {
            take_keys();
            const auto passed = now().steady - drawn_;
            if (passed >= (is_changed_ ? shortest_between_pictures : longest_between_pictures)) {
                draw();
            }
        });
    } catch (const Interrupted&) {
        if (!connection_->is_hung_up()) {
            return Exit::Interrupted;
        }
    }
    if (connection_->is_hung_up() || stream_.has_lost_input()) {
        return Exit::HungUp;
    }
    const std::size_t bad = count_bad(statuses_);
    return bad == 0 ? Exit::Good : bad == statuses_.size() ? Exit::Failed : Exit::Partly;
}

void View::show_value(std::size_t row, const DataValue& value)
{
    if (!stream_.count()) {
        return;
    }
    ++versions_[row];
    model_.set_value(row, value, told(row, value), now());
    is_changed_ = true;
    if (value.value.type() == BuiltInType::ExtensionObject) {
        learn_types(row, value);
    }
}

/// The value on one line, rounded to what can be seen at a glance.
std::string View::told(std::size_t row, const DataValue& value)
{
    constexpr int digits = 6;
    const ValueFacts& facts = nodes_[row].facts;
    const std::string text =
        text_of(value, connection_->types().types(), {facts.data_type, digits});
    return facts.unit.empty() || value.status.is_bad() ? text : text + " " + facts.unit;
}

void View::learn_types(std::size_t row, const DataValue& value)
{
    const client::NodeAddress& address = nodes_[row].node.address;
    connection_->types().learn_values(
        {value.value}, {address.node_id(connection_->client().server()).value_or(NodeId{})},
        [this, row, version = versions_[row], value] {
            stream_.push([this, row, version, value] {
                if (versions_[row] == version) {
                    model_.set_text(row, told(row, value));
                    is_changed_ = true;
                }
            });
        });
}

void View::show_event(const Array<Variant>& fields)
{
    if (fields.size() == standard_event_fields.size()) {
        model_.add_event({fields[0].value_or<DateTime>({}), fields[1].value_or<std::uint16_t>(0),
                          plain_text(fields[2]), plain_text(fields[3])});
        is_changed_ = true;
    }
}

void View::show_events_status(StatusCode status)
{
    model_.set_event_note(status.is_bad() ? "the server offers none: " + text_of(status) : "");
    is_changed_ = true;
}

void View::set_connected()
{
    const EndpointDescription* const endpoint = connection_->client().endpoint();
    const bool is_secure =
        endpoint != nullptr && endpoint->security_mode != MessageSecurityMode::None;
    model_.link().connected(security_text(endpoint, context_->options), is_secure, now());
    is_changed_ = true;
}

void View::take_keys()
{
    while (const auto key = terminal_->next_key()) {
        take_key(*key);
        draw();
    }
}

void View::take_key(const Key& key)
{
    if (key.kind == Key::Kind::Redraw) {
        terminal_->forget();
    } else if (model_.prompt()) {
        edit(key);
    } else {
        act(action_of(key));
    }
}

void View::edit(const Key& key)
{
    Prompt& prompt = *model_.prompt();
    const bool is_filter = prompt.kind == Prompt::Kind::Filter;
    const LineEditor::State state = prompt.line.take(key);
    const std::string text = state == LineEditor::State::Cancelled ? "" : prompt.line.text();
    if (is_filter) {
        model_.set_filter(text);
    }
    if (state == LineEditor::State::Editing) {
        return;
    }
    model_.prompt().reset();
    if (!is_filter && state == LineEditor::State::Accepted) {
        write(text);
    }
}

void View::act(Action action)
{
    if (action == Action::Quit) {
        stream_.stop();
    } else if (action == Action::Write) {
        begin_write();
    } else {
        model_.apply(action, now());
    }
}

void View::begin_write()
{
    const auto row = model_.selected();
    if (!row) {
        return;
    }
    writing_ = *row;
    const std::string name = safe(nodes_[*row].name);
    model_.tell(name + ": asking for its type");
    writer_.prepare(nodes_[*row].node.address, [this, name](const std::string& type,
                                                            const std::string& refusal) {
        if (refusal.empty()) {
            model_.open_prompt(
                {Prompt::Kind::Write, "write " + name + " (" + type + "): ", LineEditor{}});
        } else {
            model_.tell(name + ": " + refusal, Style::Bad);
        }
        is_changed_ = true;
    });
}

void View::write(const std::string& text)
{
    const std::string name = safe(nodes_[writing_].name);
    model_.tell(name + ": writing");
    writer_.write(text, [this, name](const LiveWriter::Outcome& outcome) {
        is_changed_ = true;
        if (!outcome.problem.empty()) {
            model_.tell(safe(outcome.problem), Style::Bad);
        } else if (outcome.status.is_bad()) {
            const std::string_view meaning = help_for(outcome.status).meaning;
            model_.tell(name + ": " + text_of(outcome.status) +
                            (meaning.empty() ? "" : ": " + std::string{meaning}),
                        Style::Bad);
        } else {
            model_.tell(name + ": written, " + text_of(outcome.status), Style::Good);
        }
    });
}

void View::draw()
{
    const Size size = terminal_->size();
    if (const auto row = model_.shows_details() ? model_.selected() : std::nullopt) {
        model_.set_details(details_of(model_.rows()[*row], nodes_[*row].node.text,
                                      nodes_[*row].facts, connection_->types().types(),
                                      size.columns));
    } else {
        model_.set_details({});
    }
    model_.fit(layout_of(model_, size).table_rows);
    const Now moment = now();
    terminal_->draw(render(model_, size, moment, context_->out.has_unicode()));
    drawn_ = moment.steady;
    is_changed_ = false;
}

std::string security_text(const EndpointDescription* endpoint, const Options& options)
{
    std::string user = "anonymous";
    if (!options.user_certificate.empty()) {
        user = "by certificate";
    } else if (!options.user.empty()) {
        user = safe(options.user);
    }
    if (endpoint == nullptr || endpoint->security_mode == MessageSecurityMode::None) {
        return "no security, " + user;
    }
    const std::string uri = safe(endpoint->security_policy_uri.view());
    const bool signs = endpoint->security_mode == MessageSecurityMode::Sign;
    return uri.substr(uri.rfind('#') + 1) + (signs ? " Sign, " : " SignAndEncrypt, ") + user;
}

} // namespace busbar::tool::watch
