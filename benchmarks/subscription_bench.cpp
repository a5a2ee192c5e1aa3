// What a notification costs a server: many items of a process image, half of which changes in each
// scan, all published to one client in the same thread. Checks that nothing is lost, comes twice or
// out of order. Time is virtual; what is measured is the processor's.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/binary/codec.hpp>
#include <busbar/channel/client_channel.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>

#include "client/stopwatch.hpp"
#include "command_line/program_options.hpp"

using namespace busbar;
using namespace std::chrono_literals;

namespace {

class FixedClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }
    DateTime time{DateTime::from_unix_seconds(1'800'000'000)};
};

class NoWaker final : public server::Waker {
public:
    void wake() override {}
};

struct Options {
    std::uint32_t items{100'000};
    double sampling_interval{200};
    Duration scan{20ms};
    int scans{100};
    int rounds{5};
};

class Bench {
public:
    explicit Bench(const Options& options) : options_{options}
    {
        add_variables();
        open();
        subscribe();
    }

    int run()
    {
        std::vector<double> costs; // us of a notification, by round
        std::size_t received = 0;
        for (int round = 0; round < options_.rounds; ++round) {
            server_time_.reset();
            received_ = 0;
            run_round(round * options_.scans);
            costs.push_back(server_time_.seconds() * 1e6 /
                            static_cast<double>(std::max<std::size_t>(received_, 1)));
            received += received_;
        }
        std::sort(costs.begin(), costs.end());
        std::printf("%u items, sampled every %g ms, %d rounds of %d scans of %lld ms: %zu "
                    "notifications, of server time each %.3f us at least, %.3f us in the median, "
                    "%zu errors\n",
                    options_.items, options_.sampling_interval, options_.rounds, options_.scans,
                    static_cast<long long>(options_.scan / 1ms), received, costs.front(),
                    costs[costs.size() / 2], errors_);
        return errors_ == 0 && received != 0 ? 0 : 1;
    }

private:
    void run_round(int first)
    {
        for (int scan = first + 1; scan <= first + options_.scans; ++scan) {
            // The even ones in one scan, the odd ones in the next.
            for (std::uint32_t i = static_cast<std::uint32_t>(scan) % 2; i < options_.items;
                 i += 2) {
                image_->memory().value<std::uint32_t>(i) = static_cast<std::uint32_t>(scan);
            }
            image_->begin_scan();
            image_->publish(clock_.time);
            pass(options_.scan);
        }
    }
    void add_variables()
    {
        server::ImageLayout layout;
        for (std::uint32_t i = 0; i < options_.items; ++i) {
            static_cast<void>(layout.add({BuiltInType::UInt32, {}, 0}));
        }
        image_ = server::ProcessImage::create(std::move(layout));
        source_ = std::make_unique<server::ImageSource>(image_);
        server::ServerConfig config;
        config.endpoints = {{{}, true}};
        server_.emplace(
            server::Server::create(
                std::move(config),
                {.random = &random_, .wall_clock = &clock_, .log = &log_, .waker = &waker_})
                .value());
        const std::uint32_t source = server_->add_source(*source_);
        for (std::uint32_t i = 0; i < options_.items; ++i) {
            model::NewVariable variable;
            variable.source = source;
            variable.handle = i;
            variable.data_type = NodeId{0, id::UInt32};
            model::NewNode node;
            node.id = NodeId{1, i};
            node.browse_name = QualifiedName{1, String{std::to_string(i)}};
            node.parent = server_->address_space().find(id::ObjectsFolder);
            static_cast<void>(server_->address_space().add_variable(node, variable));
        }
        image_->begin_scan();
        image_->publish(clock_.time);
    }

    /// Carries bytes both ways until nothing moves.
    void talk()
    {
        for (bool moved = true; moved;) {
            moved = !client_->output().empty() || !connection_->output().empty();
            const std::vector<std::byte> request{client_->output().begin(),
                                                 client_->output().end()};
            client_->consume(request.size());
            server_time_.time([&] {
                static_cast<void>(connection_->feed(request, now_));
                while (connection_->next_deadline() <= now_) { // large requests have turns
                    connection_->handle_deadline(now_);
                }
            });
            static_cast<void>(client_->feed(connection_->output(), now_));
            connection_->consume(connection_->output().size());
            while (auto event = client_->next_event()) {
                if (event->kind == channel::ChannelEvent::Kind::Message) {
                    take(*event);
                }
            }
        }
    }
    void pass(Duration time)
    {
        now_ += time;
        clock_.time.ticks += time.count() / 100;
        server_time_.time([&] {
            server_->handle_completions(now_);
            server_->handle_deadline(now_);
        });
        talk();
    }

    template <typename Request>
    void send(Request request)
    {
        request.request_header.authentication_token = token_;
        static_cast<void>(client_->send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, Request::binary_encoding_id});
            encode(writer, request);
        }));
        talk();
    }
    void take(const channel::ChannelEvent& event)
    {
        binary::Reader reader{event.body, binary::Strings::Borrow, &types_};
        NodeId type;
        decode(reader, type);
        if (type.is(CreateSessionResponse::binary_encoding_id)) {
            CreateSessionResponse response;
            decode(reader, response);
            token_ = response.authentication_token;
        } else if (type.is(CreateSubscriptionResponse::binary_encoding_id)) {
            CreateSubscriptionResponse response;
            decode(reader, response);
            subscription_ = response.subscription_id;
        } else if (type.is(PublishResponse::binary_encoding_id)) {
            PublishResponse response;
            decode(reader, response);
            check(response.notification_message);
            acknowledge_ = response.notification_message.sequence_number;
            publish();
        } else if (type.is(ServiceFault::binary_encoding_id)) {
            ++errors_;
        }
    }
    void publish()
    {
        PublishRequest request;
        request.subscription_acknowledgements = {{subscription_, acknowledge_}};
        request.request_header.authentication_token = token_;
        static_cast<void>(client_->send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, PublishRequest::binary_encoding_id});
            encode(writer, request);
        }));
    }
    /// Each value is newer than the one before; sampled at each scan, by exactly two scans.
    void check(const NotificationMessage& message)
    {
        for (const ExtensionObject& part : message.notification_data) {
            const auto* changes = part.get_if<DataChangeNotification>();
            if (changes == nullptr) {
                ++errors_;
                continue;
            }
            for (const MonitoredItemNotification& one : changes->monitored_items) {
                const auto value = one.value.value.value_or<std::uint32_t>(0);
                std::uint32_t& last = last_[one.client_handle];
                const bool is_next =
                    options_.sampling_interval != 0 || last == 0 || value == last + 2;
                errors_ += (value == 0 && last == 0) || (value > last && is_next) ? 0U : 1U;
                last = value;
                ++received_;
            }
        }
    }

    void open()
    {
        connection_.emplace(server_->connect("192.0.2.1", now_).value());
        channel::ClientChannelConfig config;
        config.endpoint_url = "opc.tcp://localhost:4840";
        client_.emplace(
            std::move(config),
            channel::ChannelEnvironment{.random = &random_, .wall_clock = &clock_, .log = &log_},
            now_);
        talk();
        CreateSessionRequest create;
        create.endpoint_url = "opc.tcp://localhost:4840";
        create.client_nonce = ByteString{std::vector<std::byte>(32, std::byte{1})};
        create.requested_session_timeout = 3'600'000;
        send(create);
        AnonymousIdentityToken anonymous;
        anonymous.policy_id = "anonymous";
        ActivateSessionRequest activate;
        activate.user_identity_token = ExtensionObject::from(anonymous);
        send(activate);
    }
    void subscribe()
    {
        CreateSubscriptionRequest create;
        create.requested_publishing_interval = options_.sampling_interval != 0 ? 200 : 100;
        create.requested_lifetime_count = 1'000;
        create.requested_max_keep_alive_count = 10;
        create.publishing_enabled = true;
        send(create);
        constexpr std::uint32_t at_once = 10'000;
        for (std::uint32_t first = 0; first < options_.items; first += at_once) {
            CreateMonitoredItemsRequest request;
            request.subscription_id = subscription_;
            request.timestamps_to_return = TimestampsToReturn::Both;
            for (std::uint32_t i = first; i < std::min(first + at_once, options_.items); ++i) {
                MonitoredItemCreateRequest item;
                item.item_to_monitor.node_id = NodeId{1, i};
                item.item_to_monitor.attribute_id = 13;
                item.monitoring_mode = MonitoringMode::Reporting;
                item.requested_parameters = {i, options_.sampling_interval, {}, 10, true};
                request.items_to_create.push_back(std::move(item));
            }
            send(request);
        }
        last_.resize(options_.items);
        for (int i = 0; i < 10; ++i) {
            publish();
        }
        pass(300ms);
    }

    Options options_;
    FixedClock clock_;
    crypto::SystemRandom random_;
    NullLog log_;
    NoWaker waker_;
    TimePoint now_{};
    std::shared_ptr<server::ProcessImage> image_;
    std::unique_ptr<server::ImageSource> source_;
    std::optional<server::Server> server_;
    std::optional<server::Connection> connection_;
    std::optional<channel::ClientChannel> client_;
    binary::TypeRegistry types_{binary::namespace0_types()};
    NodeId token_;
    std::uint32_t subscription_{0};
    std::uint32_t acknowledge_{0};
    std::vector<std::uint32_t> last_;
    bench::Stopwatch server_time_;
    std::size_t received_{0};
    std::size_t errors_{0};
};

} // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app{"Measures what a notification costs a server: items of a process image, half of "
                 "which change in each scan, published to one client. Ends with 1 if one is lost."};
    app.add_option("items", options.items, "monitored items")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    app.add_option("interval", options.sampling_interval, "sampling in ms; 0 is each scan")
        ->check(CLI::Range(0.0, 3'600'000.0))
        ->capture_default_str();
    app.add_option("scans", options.scans, "scans of a round")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    app.add_option("--rounds", options.rounds, "rounds, of which the least and the median are told")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    command_line::add_program_options(app, "busbar-subscription-bench");
    CLI11_PARSE(app, argc, argv);
    return Bench{options}.run();
}
