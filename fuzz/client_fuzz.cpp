#include <cstdint>
#include <vector>

#include <busbar/client/client.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/view.hpp>

#include "fuzz_script.hpp"
#include "hostile_publisher.hpp"
#include "support/rogue_server.hpp"

namespace client_fuzz {

using namespace busbar;

namespace {

/// A whole client with a Subscription, and a server whose answers the script makes or changes.
class Fixture {
public:
    explicit Fixture(fuzz::Script& script)
        : script_{&script}, publisher_{script}, client_{config(), environment(), now_}
    {
        answers_.raw = [this](const NodeId&) { return answer(); };
        answers_.other = [this](const NodeId& id, binary::Reader& reader) {
            return publisher_.answer(id, reader);
        };
        answers_.body = [this](std::vector<std::byte>& body) { change(body); };
        watch();
        client_.connect(now_);
        run();
    }
    void step()
    {
        switch (script_->byte() % 10) {
        case 0:
            static_cast<void>(client_.feed(script_->bytes(script_->byte()), now_));
            break;
        case 1:
            now_ += std::chrono::milliseconds{script_->byte() * 100};
            client_.handle_deadline(now_);
            break;
        case 2:
            server_.reset();
            client_.disconnected(order_, status::Bad_ConnectionClosed, now_);
            break;
        case 3:
            ask<BrowseResponse>(BrowseRequest{});
            break;
        case 4:
            watch();
            break;
        case 5:
        case 8:
            publish();
            break;
        case 6:
            client_.close(now_);
            client_.connect(now_);
            break;
        case 9:
            wish();
            break;
        default:
            ask<ReadResponse>(ReadRequest{});
        }
        run();
    }

private:
    [[nodiscard]] static client::ClientConfig config()
    {
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        config.security.allows_none = true;
        return config;
    }
    [[nodiscard]] channel::ChannelEnvironment environment()
    {
        return {.random = &random_, .wall_clock = &wall_clock_, .log = &log_};
    }
    template <typename Response, typename Request>
    void ask(Request request)
    {
        client_.call<Response>(std::move(request), [](Result<Response>) {});
    }
    /// Another Subscription: for values, for events, and for what a path leads to.
    void watch()
    {
        client::SubscriptionHandlers handlers;
        handlers.on_data = [this](std::span<const client::DataChange> changes) {
            heard_ += changes.size();
        };
        handlers.on_events = [this](std::span<const client::EventArrived> events) {
            heard_ += events.size();
        };
        handlers.on_gap = [this](const client::Gap&) { ++heard_; };
        auto subscription = client_.subscriptions().create({}, std::move(handlers));
        if (!subscription) {
            return;
        }
        std::vector<client::ItemSettings> items(3);
        items[0].node = NodeId{0, 2258U};
        items[1].node = NodeId{0, 2253U};
        items[1].filter = ExtensionObject::from(EventFilter{});
        items[2].node = NodeId{0, 2259U};
        items[2].mode = MonitoringMode::Sampling;
        items_ = client_.subscriptions().add_items(*subscription, std::move(items)).value();
        subscription_ = *subscription;
    }
    /// The server answers a Publish request, with a notification or with anything.
    void publish()
    {
        if (!server_ || server_->unanswered.empty()) {
            return;
        }
        const std::uint32_t request = server_->unanswered.front();
        server_->unanswered.pop_front();
        auto body = publisher_.publish();
        change(body);
        server_->send(request, body);
    }
    /// The user changes what there is.
    void wish()
    {
        auto& subscriptions = client_.subscriptions();
        const std::array one{items_[script_->byte() % items_.size()]};
        client::ItemSettings settings;
        settings.sampling_interval = std::chrono::milliseconds{script_->byte()};
        switch (script_->byte() % 5) {
        case 0:
            settings.mode = static_cast<MonitoringMode>(script_->byte() % 4);
            static_cast<void>(subscriptions.modify_items(one, settings));
            break;
        case 1:
            static_cast<void>(subscriptions.remove_items(one));
            break;
        case 2:
            static_cast<void>(subscriptions.set_triggering(items_[0], {one[0]}));
            break;
        case 3: {
            client::SubscriptionSettings wanted;
            wanted.is_publishing_enabled = script_->byte() % 2 == 0;
            static_cast<void>(subscriptions.modify(subscription_, wanted));
            break;
        }
        default:
            static_cast<void>(subscriptions.remove(subscription_));
        }
    }
    /// Honest, silent, or any structure of namespace 0 with fields from the script.
    [[nodiscard]] std::optional<std::vector<std::byte>> answer()
    {
        const std::uint8_t kind = script_->byte();
        if (kind < 192) {
            return std::nullopt;
        }
        if (kind == 192) {
            return std::vector<std::byte>{};
        }
        const auto table = binary::namespace0_types();
        const std::size_t choice = script_->byte() + std::size_t{script_->byte()} * 256;
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, table[choice % table.size()]->binary_encoding_id.in(0));
        encode(writer, ResponseHeader{});
        writer.bytes(script_->bytes(script_->byte()));
        return sink.take(writer.written());
    }
    void change(std::vector<std::byte>& body)
    {
        const int changes = script_->byte() % 4;
        for (int i = 0; i < changes && !body.empty(); ++i) {
            const std::size_t at = script_->byte() + std::size_t{script_->byte()} * 256;
            body[at % body.size()] = static_cast<std::byte>(script_->byte());
        }
    }
    /// Bounded: a server that refuses at once is not asked again before its time.
    void run()
    {
        bool moved = true;
        for (int i = 0; i < 200 && moved; ++i) {
            moved = client_.poll(now_, 100);
            if (server_) {
                moved = test::carry(client_, *server_, now_) || moved;
                moved = test::carry(*server_, client_, now_) || moved;
            }
            if (const auto order = client_.next_order()) {
                obey(*order);
                moved = true;
            }
        }
    }
    void obey(const client::TransportOrder& order)
    {
        server_.reset();
        order_ = order.id;
        if (order.kind == client::TransportOrder::Kind::Drop) {
            client_.disconnected(order_, {}, now_);
            return;
        }
        server_.emplace(answers_, environment(), now_);
        client_.connected(order_, now_);
    }

    fuzz::Script* script_;
    fuzz::HostilePublisher publisher_;
    test::SeededRandom random_;
    test::FixedWallClock wall_clock_;
    NullLog log_;
    TimePoint now_{};
    test::RogueAnswers answers_;
    std::optional<test::RogueServer> server_;
    std::uint64_t order_{0};
    client::SubscriptionHandle subscription_{0};
    std::vector<client::ItemHandle> items_;
    std::size_t heard_{0};
    client::Client client_;
};

} // namespace

/// A client from GetEndpoints to its requests and Subscriptions, against a server that says what it
/// likes.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    Fixture fixture{script};
    for (int step = 0; step < 24 && !script.is_over(); ++step) {
        fixture.step();
    }
    return 0;
}

} // namespace client_fuzz
