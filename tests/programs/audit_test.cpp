#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <busbar/client/event_filter.hpp>
#include <busbar/client/subscriptions.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/system.hpp>
#include <busbar/product/controller.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "support/kept_key.hpp"
#include "support/temporary_folder.hpp"

namespace audit_test {

// The audit events of a controller whose mode switch is turned.

using namespace busbar;
using namespace busbar::product;
using namespace std::chrono_literals;

namespace {

constexpr const char* client_uri = "urn:busbar:test:audit";
constexpr const char* password = "patience is all";

/// A PLC with a mode switch.
class SwitchedRuntime final : public Runtime {
public:
    void begin(RuntimeHost& host) override { host_ = &host; }
    Configured<std::unique_ptr<LoadedProgram>> load(controller::Plc&,
                                                    const controller::Program*) override
    {
        struct Idle final : LoadedProgram {
            void scan(DateTime, Duration) override {}
        };
        return std::make_unique<Idle>();
    }
    void mode_changed(controller::MachineMode mode) override { mode_ = mode; }
    /// Turns the switch, and waits for the mode; a switch that is refused ends the test.
    void turn(controller::MachineMode mode)
    {
        host_->switch_mode(mode);
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (mode_ != mode && std::chrono::steady_clock::now() < deadline) {
            std::this_thread::sleep_for(1ms);
        }
        REQUIRE(mode_ == mode);
    }

private:
    RuntimeHost* host_{nullptr};
    std::atomic<controller::MachineMode> mode_{controller::MachineMode::Run};
};

/// Returns a port that has no listener now, below those of scripts and of outgoing connections.
std::uint16_t free_port()
{
    std::random_device random;
    for (int tried = 0; tried < 100; ++tried) {
        const auto port = static_cast<std::uint16_t>(10'000 + random() % 10'000);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(port);
        const int handle = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const bool is_free =
            ::bind(handle, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
        ::close(handle);
        if (is_free) {
            return port;
        }
    }
    FAIL("each port has a listener");
    return 0;
}

channel::ApplicationIdentity client_identity()
{
    crypto::CertificateSubject subject;
    subject.common_name = "audit";
    subject.application_uri = client_uri;
    subject.valid_from = net::SystemWallClock{}.now();
    subject.valid_days = 10;
    const crypto::PrivateKey key = test::kept_key("audit", 2'048);
    return {{crypto::create_self_signed(key, subject).value()}, key};
}

/// A controller that runs, in RUN.
class AuditedController {
public:
    AuditedController()
    {
        crypto::SystemRandom random;
        const auto hash = crypto::hash_password(
            password, random, {.scheme = crypto::PasswordScheme::Pbkdf2, .iterations = 10'000});
        REQUIRE(hash);
        std::ofstream{path("p.st")} << "VAR_GLOBAL\nLevel : LREAL;\nEND_VAR\n";
        std::ofstream{path("c.toml")}
            << "[server]\naddress = \"127.0.0.1\"\nauditing = true\nport = " << port_
            << "\n[certificates]\nfolder = \"" << path("pki")
            << "\"\ntrust_all_clients = true\n[[endpoint]]\npolicy = \"Basic256Sha256\"\n"
               "mode = \"SignAndEncrypt\"\n[machine]\nmode = \"RUN\"\nprogram = \""
            << path("p.st") << "\"\nstate = \"" << path("state")
            << "\"\n[[users.account]]\nname = \"chief\"\npassword = \"" << *hash
            << "\"\nroles = [\"SecurityAdmin\", \"ConfigureAdmin\", \"Engineer\"]\n";
        auto made = Controller::create({.file = path("c.toml")}, runtime, options_);
        REQUIRE(made);
        controller_ = *std::move(made);
        serving_ = std::thread{[this] { static_cast<void>(controller_->run()); }};
    }
    AuditedController(const AuditedController&) = delete;
    AuditedController& operator=(const AuditedController&) = delete;
    ~AuditedController()
    {
        controller_->stop();
        serving_.join();
    }
    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port_); }

    SwitchedRuntime runtime;

private:
    [[nodiscard]] std::string path(const std::string& name) const
    {
        return (folder_.path / name).string();
    }

    test::TemporaryFolder folder_;
    std::uint16_t port_{free_port()};
    NullLog log_;
    ControllerOptions options_{.log = &log_, .takes_signals = false, .greets = false};
    std::unique_ptr<Controller> controller_;
    std::thread serving_;
};

/// An administrator who gets audit events.
class Auditor {
public:
    explicit Auditor(const std::string& url) : client_{config_of(url), environment_}
    {
        REQUIRE(client_.connect(120s));
        client::SubscriptionHandlers handlers;
        handlers.on_events = [this](std::span<const client::EventArrived> arrived) {
            for (const client::EventArrived& event : arrived) {
                const auto type = event.fields[0].value_or<NodeId>({});
                if (type == method || type == write || type == security) {
                    types_.push_back(type);
                }
            }
        };
        bool has_item = false;
        handlers.on_item = [&](client::ItemHandle, const client::ItemStatus& item) {
            has_item = item.status.is_good();
        };
        auto& subscriptions = client_.client().subscriptions();
        const auto subscription = subscriptions.create({.publishing_interval = 10ms}, handlers);
        REQUIRE(subscription);
        client::ItemSettings item;
        item.node = NodeId{0, id::Server};
        item.attribute = AttributeId::EventNotifier;
        item.queue_size = 100;
        item.filter = ExtensionObject::from(
            client::event_filter({.fields = {"EventType"}, .type = NodeId{0, id::AuditEventType}}));
        REQUIRE(subscriptions.add_items(*subscription, {item}));
        REQUIRE(client_.run_until([&] { return has_item; }, 120s));
    }

    /// The types of the events of changes since the last call. The last event is that of a Method
    /// which is called now and changes nothing.
    std::vector<NodeId> heard()
    {
        ++calls_;
        static_cast<void>(call(NodeId{0, id::UserManagement},
                               NodeId{0, id::UserManagement_RemoveUser}, {Variant{"stranger"}}));
        const auto methods = [&] { return std::count(types_.begin(), types_.end(), method); };
        REQUIRE(client_.run_until([&] { return methods() >= calls_; }, 120s));
        types_.pop_back();
        calls_ = 0;
        return std::exchange(types_, {});
    }
    /// Writes a setting.
    void set(const char* setting, Variant value)
    {
        WriteRequest request;
        WriteValue& one = request.nodes_to_write.emplace_back();
        one.node_id = NodeId{1, String{std::string{"Settings."} + setting}};
        one.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        one.value.value = std::move(value);
        const auto response = client_.call<WriteResponse>(std::move(request));
        REQUIRE(response);
        CHECK(name(response->results[0]) == "Good");
    }
    /// Sends an empty file to the service of programs, by two Methods.
    void send(const char* wish)
    {
        const NodeId program{1, "Transfers/Program"};
        const auto made =
            call(program, NodeId{0, id::TemporaryFileTransferType_GenerateFileForWrite},
                 {Variant{wish}});
        REQUIRE(name(made.status_code) == "Good");
        const auto sent = call(program, NodeId{0, id::TemporaryFileTransferType_CloseAndCommit},
                               {made.output_arguments[1]});
        CHECK(name(sent.status_code) == "Good");
        calls_ += 2;
    }
    CallMethodResult call(const NodeId& object, const NodeId& node, std::vector<Variant> inputs)
    {
        CallRequest request;
        CallMethodRequest& one = request.methods_to_call.emplace_back();
        one.object_id = object;
        one.method_id = node;
        one.input_arguments = Array<Variant>{std::move(inputs)};
        auto response = client_.call<CallResponse>(std::move(request));
        REQUIRE(response);
        return std::move(response->results[0]);
    }

    const NodeId method{0, id::AuditUpdateMethodEventType};
    const NodeId write{0, id::AuditWriteUpdateEventType};
    const NodeId security{0, id::AuditSecurityEventType};

private:
    [[nodiscard]] static client::ClientConfig config_of(const std::string& url)
    {
        client::ClientConfig config;
        config.endpoint_url = url;
        config.identity = client::NamedUser{"chief", password};
        config.application_uri = client_uri;
        config.request_timeout = 120s;
        config.connect_timeout = 120s;
        return config;
    }

    NullLog log_;
    crypto::SystemRandom random_;
    net::SystemWallClock wall_clock_;
    crypto::InsecureAcceptAnyCertificate any_;
    channel::ApplicationIdentity identity_{client_identity()};
    channel::ChannelEnvironment environment_{.random = &random_,
                                             .wall_clock = &wall_clock_,
                                             .log = &log_,
                                             .validator = &any_,
                                             .identity = &identity_};
    std::vector<NodeId> types_;
    std::ptrdiff_t calls_{0};
    net::BlockingClient client_;
};

} // namespace

TEST_CASE("audit: a change of the mode has one event, whichever way it comes (Part 4, 6.5)")
{
    using Types = std::vector<NodeId>;
    AuditedController controller;
    Auditor auditor{controller.url()};
    CHECK(auditor.heard() == Types{});
    controller.runtime.turn(controller::MachineMode::Program);
    CHECK(auditor.heard() == Types{auditor.security});
    controller.runtime.turn(controller::MachineMode::Run);
    CHECK(auditor.heard() == Types{auditor.security});
    auditor.set("machine.mode", Variant{"PROGRAM"});
    CHECK(auditor.heard() == Types{auditor.write});
    auditor.send("mode RUN");
    CHECK(auditor.heard() == Types{auditor.method, auditor.method});
}

} // namespace audit_test
