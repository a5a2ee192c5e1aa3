#include "node_feed.hpp"

#include <CLI/CLI.hpp>

#include "nodes.hpp"

namespace busbar::tool {

void add_feed_options(CLI::App& command, FeedSettings& settings)
{
    command.add_option("-i,--interval", settings.interval, "publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command.add_option("--sampling", settings.sampling, "-1 for the publishing interval")
        ->type_name("MS")
        ->capture_default_str();
    command.add_option("--queue", settings.queue_size, "values kept between two publishings")
        ->type_name("N")
        ->capture_default_str();
}

std::vector<FeedNode> parse_feed(const std::vector<std::string>& texts)
{
    std::vector<FeedNode> nodes;
    nodes.reserve(texts.size());
    for (const std::string& text : texts) {
        nodes.push_back({text, parse_address(text)});
    }
    return nodes;
}

std::vector<std::string> texts_of(const std::vector<FeedNode>& nodes)
{
    std::vector<std::string> texts;
    texts.reserve(nodes.size());
    for (const FeedNode& node : nodes) {
        texts.push_back(node.address.text());
    }
    return texts;
}

NodeFeed::NodeFeed(Connection& connection, Stream& stream, const FeedSettings& settings,
                   std::vector<FeedNode> nodes, FeedHandlers handlers)
    : connection_{&connection}, stream_{&stream}, nodes_{std::move(nodes)}, handlers_{
                                                                                std::move(handlers)}
{
    subscribe(settings);
}

void NodeFeed::subscribe(const FeedSettings& settings)
{
    client::SubscriptionSettings wanted;
    wanted.publishing_interval = decltype(wanted.publishing_interval){settings.interval};
    auto handlers = stream_->handlers();
    handlers.on_data = [this](std::span<const client::DataChange> changes) {
        for (const client::DataChange& change : changes) {
            stream_->push(
                [this, change] { handlers_.on_value(node_of_.at(change.item), change.value); });
        }
    };
    handlers.on_events = [this](std::span<const client::EventArrived> events) {
        for (const client::EventArrived& event : events) {
            stream_->push([this, fields = event.fields] { on_event_(fields); });
        }
    };
    handlers.on_item = [this](client::ItemHandle item, const client::ItemStatus& status) {
        stream_->push([this, item, code = status.status] { take_status(item, code); });
    };
    auto& subscriptions = connection_->client().subscriptions();
    subscription_ =
        connection_->value(subscriptions.create(wanted, std::move(handlers)), "the subscription");
    std::vector<client::ItemSettings> items;
    for (const FeedNode& node : nodes_) {
        client::ItemSettings& item = items.emplace_back();
        item.node = node.address;
        item.sampling_interval = decltype(item.sampling_interval){settings.sampling};
        item.queue_size = settings.queue_size;
    }
    const auto handles = connection_->value(
        subscriptions.add_items(subscription_, std::move(items)), "the monitored items");
    for (std::size_t i = 0; i < handles.size(); ++i) {
        node_of_.emplace(handles[i], i);
    }
}

void NodeFeed::add_events(client::ItemSettings item,
                          std::function<void(const Array<Variant>&)> on_event,
                          std::function<void(StatusCode)> on_status)
{
    on_event_ = std::move(on_event);
    on_event_status_ = std::move(on_status);
    static_cast<void>(connection_->value(
        connection_->client().subscriptions().add_items(subscription_, {std::move(item)}),
        "the monitored item of events"));
}

void NodeFeed::take_status(client::ItemHandle item, StatusCode status)
{
    if (const auto found = node_of_.find(item); found != node_of_.end()) {
        handlers_.on_status(found->second, status);
    } else {
        on_event_status_(status);
    }
}

} // namespace busbar::tool
