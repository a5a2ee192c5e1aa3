#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/administration/administration.hpp>
#include <busbar/administration/audit_log.hpp>
#include <busbar/core/storage_folder.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/server/waker.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "crypto/issuing.hpp"
#include "support/server_fixture.hpp"

namespace busbar::test {

// Modes of Open (Part 20, 4.2.2).
inline constexpr std::uint8_t reading = 1;
inline constexpr std::uint8_t writing = 6;

/// Does its jobs when it is told to.
class ManualWorker final : public server::Worker {
public:
    [[nodiscard]] bool run(std::function<void()> job) override
    {
        jobs.push_back(std::move(job));
        return has_room;
    }
    void work()
    {
        for (auto& job : std::exchange(jobs, {})) {
            job();
        }
    }

    std::vector<std::function<void()>> jobs;
    bool has_room{true};
};

struct NoteWaker final : server::Waker {
    void wake() override { is_awake = true; }

    bool is_awake{false};
};

/// Keeps to what it is told, and has no more than ten sessions.
struct PlainOwner final : administration::SettingOwner {
    [[nodiscard]] Variant value(const administration::Setting& setting) const override
    {
        const auto found = applied.find(setting.name);
        return found == applied.end() ? setting.otherwise : found->second;
    }
    [[nodiscard]] bool waits_for_restart(const administration::Setting& setting) const override
    {
        return setting.name == "server.port" && applied.contains(setting.name);
    }
    [[nodiscard]] Configured<void> check(const administration::SettingValues& changes) override
    {
        if (changes.contains("server.port") && refuses_port) {
            return misconfigured("server.port", "cannot change now", status::Bad_InvalidState);
        }
        const auto found = changes.find("limits.sessions");
        return found != changes.end() && found->second == Variant{std::int64_t{13}}
                   ? misconfigured("limits.sessions", "found 13, expected luck")
                   : Configured<void>{};
    }
    void apply(const administration::SettingValues& changes) override { applied = changes; }

    administration::SettingValues applied;
    bool refuses_port{false};
};

/// Gives `made` for null options, as many bytes as the options say for a number, and takes what it
/// is given unless it was told an answer.
struct PlainTransfers final : administration::TransferOwner {
    [[nodiscard]] Result<std::vector<std::byte>>
    generate(const administration::TransferRequest& request, std::size_t max_size) override
    {
        last_max_size = max_size;
        if (const auto* const size = request.options.get_if<std::uint32_t>()) {
            return std::vector<std::byte>(*size);
        }
        return request.options.is_null() ? Result<std::vector<std::byte>>{made}
                                         : fail(status::Bad_InvalidArgument);
    }
    [[nodiscard]] StatusCode may_take(const administration::TransferRequest& request) override
    {
        return request.options.get_if<bool>() != nullptr ? status::Bad_InvalidArgument
                                                         : status::Good;
    }
    [[nodiscard]] StatusCode take(const administration::TransferRequest& request,
                                  std::span<const std::byte> bytes) override
    {
        if (answer.is_good()) {
            taken.emplace_back(bytes.begin(), bytes.end());
            options = request.options;
            user = request.user.name;
            session = request.session;
        }
        return answer;
    }

    [[nodiscard]] std::function<void()> preparation(const administration::TransferRequest&,
                                                    std::span<const std::byte> bytes) override
    {
        if (!is_slow) {
            return {};
        }
        return [this, bytes] { prepared.emplace_back(bytes.begin(), bytes.end()); };
    }

    [[nodiscard]] std::string why_refused() const override { return why; }

    std::string why;
    bool is_slow{false}; // takes files on a worker
    std::vector<std::vector<std::byte>> prepared;
    std::vector<std::byte> made;
    std::size_t last_max_size{0};
    StatusCode answer;
    std::vector<std::vector<std::byte>> taken;
    Variant options;
    std::string user;
    NodeId session;
};

/// A server whose certificates and users are managed, in memory and in virtual time. Trusts the
/// client of the tests; "admin" is SecurityAdmin.
struct ManagedFixture {
    /// How the program starts its server again.
    enum class Restart : std::uint8_t { Not, ByEnding, ByReplacing, ByGoingOn };

    explicit ManagedFixture(server::Worker* w = nullptr,
                            administration::Authorities of = administration::Authorities::Standard,
                            Restart how = Restart::ByEnding)
        : worker{w}, authorities{of}, restart_how{how}
    {
        REQUIRE(applications.create());
        REQUIRE(user_certificates.create());
        REQUIRE(applications.add(crypto::StoreList::Trusted,
                                 client_identity().certificates.front().der()));
        const crypto::OwnCertificateStore own{storage};
        REQUIRE(own.install({server_identity().certificates, server_identity().key},
                            "urn:busbar:test:server"));
        REQUIRE(roles.load());
        REQUIRE(user_list.load());
        REQUIRE(user_list.add({"admin", {}, 0, {}, {"SecurityAdmin"}}, "admin-secret!", random));
        attach();
    }

    /// All files at the root, and the trusted certificates.
    Configured<void> reset()
    {
        static constexpr std::array<std::string_view, 2> names{"users.json", "roles.json"};
        static constexpr std::array<std::string_view, 1> folders{"trusted/certs"};
        return administration::remove_files(storage, names, folders);
    }
    void attach()
    {
        std::function<void()> restart;
        std::function<void(const administration::RestartWish&)> replace;
        if (restart_how != Restart::Not) {
            restart = [this] { ++restarts; };
        }
        std::function<void(const std::string&)> shut_down;
        if (restart_how == Restart::ByGoingOn) {
            shut_down = [this](const std::string& reason) { told_reason = reason; };
        }
        if (restart_how == Restart::ByReplacing) {
            replace = [this](const administration::RestartWish& asked) { wish = asked; };
        }
        administration =
            std::make_unique<administration::Administration>(administration::AdministrationParts{
                .wall_clock = &wall_clock,
                .log = &audit,
                .roles = &roles,
                .users = &user_list,
                .certificates = &certificates,
                .random = &random,
                .worker = worker,
                .stop = [this] { ++stops; },
                .shut_down = std::move(shut_down),
                .may_run = [this] { return out ? Unexpected{*out} : Configured<void>{}; },
                .restart = std::move(restart),
                .replace = std::move(replace),
                .may_replace =
                    [this] {
                        return
                            [this] { return refusal ? Unexpected{*refusal} : Configured<void>{}; };
                    },
                .reset = [this] { return reset(); },
                .is_in_setup = [this] { return changes == 0; },
                .may_administer = [this](const auto& user) { return user.name != suspended; },
                .may_change_users =
                    [this] { return hold ? Unexpected{*hold} : Configured<void>{}; },
                .settings = &settings,
                .setting_owner = &owner,
                .file_systems = {files},
                .file_transfers = {transfer},
                .status = {{"RestartDue", Variant{false}, [] { return Variant{true}; }},
                           {"Users", Variant{Array<String>{"x"}},
                            [] {
                                return Variant{Array<String>{"admin", "pat"}};
                            }}},
                .authorities = authorities,
                .changed = [this] { ++changes; }});
        REQUIRE(administration->attach(server));
    }

    [[nodiscard]] TestClient
    connect(MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt,
            const channel::ApplicationIdentity& identity = client_identity())
    {
        return connect_to(server, mode, identity);
    }
    /// Another server than the fixture's own.
    [[nodiscard]] TestClient
    connect_to(server::Server& other,
               MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt,
               const channel::ApplicationIdentity& identity = client_identity())
    {
        return {other.connect("192.0.2.1", now).value(), setting("Basic256Sha256", mode),
                channel::ChannelEnvironment{.random = &random,
                                            .wall_clock = &wall_clock,
                                            .log = &log,
                                            .validator = &any,
                                            .identity = &identity},
                now};
    }
    [[nodiscard]] TestClient log_in(const char* name = "admin",
                                    const char* password = "admin-secret!",
                                    MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
    {
        TestClient client = connect(mode);
        REQUIRE(client.create_session());
        const StatusCode activated = client.activate(client.user(name, password));
        REQUIRE_FALSE(activated.is_bad());
        return client;
    }
    CallMethodResult call(TestClient& client, const NodeId& object, const NodeId& method,
                          std::vector<Variant> inputs)
    {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = object;
        request.methods_to_call[0].method_id = method;
        request.methods_to_call[0].input_arguments = Array<Variant>{inputs};
        const auto sent = client.send(request);
        complete();
        const auto response = client.take<CallResponse>(sent);
        REQUIRE(response);
        return response->results[0];
    }
    /// What Methods left for the server's thread.
    void complete()
    {
        while (std::exchange(waker.is_awake, false)) {
            server.handle_completions(now);
        }
    }
    static DataValue read(TestClient& client, std::uint32_t node)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{0, node};
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0];
    }
    void advance(Duration time)
    {
        now += time;
        wall_clock.time.ticks += time.count() / 100;
        server.handle_deadline(now);
    }
    [[nodiscard]] std::size_t count(crypto::CertificateStore& store, crypto::StoreList list) const
    {
        return store.list(list).size();
    }

    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    /// Passes all on to `log`; makes events once it is attached.
    administration::AuditLog audit{log};
    crypto::InsecureAcceptAnyCertificate any;
    storage::MemoryStorage storage;
    StorageFolder user_files{storage, "users"};
    crypto::CertificateStore applications{storage, {}, log};
    crypto::CertificateStore user_certificates{user_files, {}, log};
    crypto::StoreValidator validator{applications, log};
    server::PasswordUsers passwords;
    administration::ConfiguredUsers configured;
    administration::RoleList roles{storage, "roles.json", {}, &configured};
    /// Hashes that cost nothing.
    administration::UserList user_list{storage,   "users.json", {.cost = {.log_n = 1}},
                                       passwords, {},           &configured};
    administration::ManagedCertificates certificates{.files = &storage,
                                                     .applications = &applications,
                                                     .users = &user_certificates,
                                                     .users_folder = "users"};
    administration::SettingList settings{
        storage,
        "settings.json",
        {{.name = "limits.sessions",
          .description = "How many there may be.",
          .otherwise = Variant{std::int64_t{100}},
          .range = Range{1, 1'000}},
         {.name = "limits.login_lock_ms", .otherwise = Variant{std::int64_t{300}}, .unit = "ms"},
         {.name = "users.anonymous", .otherwise = Variant{"no"}, .is_security = true},
         {.name = "server.port", .otherwise = Variant{std::int64_t{4'840}}},
         {.name = "server.host_names", .otherwise = Variant{Array<String>{"press-4"}}}}};
    PlainOwner owner;
    StorageFolder file_storage{storage, "files"};
    administration::FileSystem files{.name = "recipes",
                                     .storage = &file_storage,
                                     .limits = {.max_entries = 12, .max_depth = 3},
                                     .readers = {NodeId{0, id::WellKnownRole_Operator}},
                                     .writers = {NodeId{0, id::WellKnownRole_Engineer}}};
    PlainTransfers transfers;
    administration::TemporaryFileTransfer transfer{
        .name = "backup",
        .owner = &transfers,
        .limits = {.max_file_size = 100'000,
                   .max_held = 150'000,
                   .max_open = 3,
                   .max_open_of_session = 2},
        .client_processing_timeout = std::chrono::seconds{20},
        .readers = {NodeId{0, id::WellKnownRole_Operator}},
        .writers = {NodeId{0, id::WellKnownRole_Engineer}}};
    server::Worker* worker;
    administration::Authorities authorities;
    Restart restart_how;
    int stops{0};
    int restarts{0};
    std::optional<administration::RestartWish> wish;
    /// Of a shutdown that the program outlives.
    std::string told_reason;
    /// Why the server may not run.
    std::optional<Problem> out;
    /// Why a restart would not work.
    std::optional<Problem> refusal;
    /// Why users and roles may not change; nothing: they may.
    std::optional<Problem> hold;
    /// Who may administer no more.
    std::string suspended;
    /// Of users and roles.
    int changes{0};
    NoteWaker waker;
    TimePoint now{};
    server::Server server{
        server::Server::create(ServerFixture::secure_config(), {.random = &random,
                                                                .wall_clock = &wall_clock,
                                                                .log = &audit,
                                                                .validator = &validator,
                                                                .users = &passwords,
                                                                .roles = &roles,
                                                                .waker = &waker})
            .value()};
    std::unique_ptr<administration::Administration> administration;
};

} // namespace busbar::test
