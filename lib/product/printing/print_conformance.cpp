#include "describe.hpp"

#include <algorithm>
#include <cstdio>

#include <busbar/administration/administration.hpp>
#include <busbar/controller/plc.hpp>
#include <busbar/controller/plc_nodes.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/user_directory.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "core/json_writer.hpp"
#include "product/access/administered.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/model/models.hpp"

namespace busbar::product {

namespace {

struct FixedClock final : WallClock {
    explicit FixedClock(DateTime t) : time{t} {}
    [[nodiscard]] DateTime now() const override { return time; }
    DateTime time;
};

/// A Waker for a server that is never run.
struct SilentWaker final : Waker {
    void wake() override {}
};

channel::ApplicationIdentity passing_identity(const ControllerConfig& config, DateTime now)
{
    auto key = expect(crypto::PrivateKey::generate(2'048), "a key");
    crypto::CertificateSubject subject;
    subject.common_name = "Busbar";
    subject.application_uri = config.server.application_uri;
    subject.valid_from = now;
    auto certificate = expect(crypto::create_self_signed(key, subject), "a certificate");
    return {{std::move(certificate)}, std::move(key)};
}

/// Adds the same nodes as `serve`, except events and Methods.
void add_nodes(server::Server& server, const ControllerConfig& config, controller::Plc& plc,
               server::ImageSource& source, LogSink& log)
{
    controller::PlcNodesOptions nodes;
    nodes.source = server.add_source(source);
    nodes.cycle = config.scan;
    static_cast<void>(
        expect(controller::publish_variables(server.address_space(), plc, nodes), "the variables"));
    SourceFiles sources;
    load_models(server, config, sources, log);
}

constexpr std::string_view no_test = "has no test";

std::string lines_of(const server::ProfileAssessment& profile)
{
    std::string text = std::string{profile.name} + (profile.is_claimed ? ": claimed\n" : ":\n");
    for (const server::UnitLack& lack : profile.lacks) {
        const bool works = lack.need == no_test;
        text += "  " + std::string{lack.unit} + ": " + (works ? "works, " : "") +
                std::string{lack.need} + "\n";
    }
    return text;
}

void add_list(busbar::detail::JsonWriter& json, std::string_view name,
              const std::vector<std::string_view>& texts)
{
    json.name(name);
    json.begin_list();
    for (const std::string_view text : texts) {
        json.string(text);
    }
    json.end_list();
}

void add_profile(busbar::detail::JsonWriter& json, const server::ProfileAssessment& profile)
{
    const auto add = [&json](std::string_view name, std::string_view value) {
        json.name(name);
        json.string(value);
    };
    json.begin_object();
    add("name", profile.name);
    add("uri", profile.uri);
    json.name("claimed");
    json.word(profile.is_claimed && !profile.is_client ? "true" : "false");
    json.name("client");
    json.word(profile.is_client ? "true" : "false");
    json.name("lacks");
    json.begin_list();
    for (const server::UnitLack& lack : profile.lacks) {
        json.begin_object();
        add("unit", lack.unit);
        add("need", lack.need);
        // The server does it; what is missing is the proof.
        json.name("works");
        json.word(lack.need == no_test ? "true" : "false");
        json.end_object();
    }
    json.end_list();
    json.end_object();
}

} // namespace

server::ProgramConformance program_of(const ControllerConfig& config, bool has_time_sync)
{
    server::ProgramConformance program;
    program.has_registration = !config.discovery.url.empty();
    program.has_reverse_connect = !config.reverse_urls.empty();
    // The configuration file has the port and the discovery server; --print-capacities is the
    // document.
    program.conformance_units = {"Discovery Configuration", "Protocol Configuration",
                                 "Documentation - Core Capacities"};
    if (has_time_sync) {
        program.conformance_units.emplace_back("Time Sync - Support");
    }
    return program;
}

server::Conformance conformance_of(ControllerConfig config, DateTime now, bool has_time_sync)
{
    NullLog log;
    crypto::SystemRandom random;
    const FixedClock clock{now};
    crypto::InsecureAcceptAnyCertificate validator;
    server::UserDirectory users;
    if (config.users.certified) {
        users.accept_certificates(validator);
    }
    if (config.users.tokens) {
        users.accept_tokens(config.users.tokens->rules);
    }
    if (config.server.application_uri.empty()) {
        config.server.application_uri = "urn:busbar:controller";
    }
    if (config.users.has_setup) { // the user "setup", and users added by it
        for (server::EndpointConfig& endpoint : config.server.endpoints) {
            endpoint.allows_user_name = true;
        }
    }
    config.server.identity = passing_identity(config, now);
    config.server.program = program_of(config, has_time_sync);
    const auto plc = expect(controller::Plc::create(config.plc, config.image));
    server::ImageSource source{plc->image()};
    storage::MemoryStorage files;
    administration::RoleList roles{files, "roles.json"};
    crypto::CertificateStore store{files, {}, log};
    administration::UserList online_users{files, "users.json", {}, users.passwords()};
    const administration::ManagedCertificates certificates{.files = &files, .applications = &store};
    const bool is_managed = manages_certificates(config);
    administration::Administration administration{
        {.wall_clock = &clock,
         .log = &log,
         .roles = &roles,
         .users = is_managed ? &online_users : nullptr,
         .certificates = is_managed ? &certificates : nullptr,
         .random = &random,
         .stop = [] {}}};
    SilentWaker waker;
    auto server = expect(server::Server::create(config.server, {.random = &random,
                                                                .wall_clock = &clock,
                                                                .log = &log,
                                                                .validator = &validator,
                                                                .users = &users,
                                                                .roles = &roles,
                                                                .waker = &waker}));
    expect(administration.attach(server));
    add_nodes(server, config, *plc, source, log);
    server.start(TimePoint{});
    return server.conformance();
}

std::string describe_conformance(const server::Conformance& conformance)
{
    std::string text;
    for (const server::ProfileAssessment& profile : conformance.profiles) {
        if (!profile.is_client) {
            text += lines_of(profile);
        }
    }
    text += std::to_string(conformance.units.size()) + " units are claimed:\n";
    for (const std::string_view unit : conformance.units) {
        text += "  " + std::string{unit} + "\n";
    }
    return text;
}

std::string conformance_json(const server::Conformance& conformance)
{
    busbar::detail::JsonWriter json;
    json.begin_object();
    json.name("profiles");
    json.begin_list();
    for (const server::ProfileAssessment& profile : conformance.profiles) {
        add_profile(json, profile);
    }
    json.end_list();
    add_list(json, "units", conformance.units);
    add_list(json, "client_units", conformance.client_units);
    json.end_object();
    return json.take() + "\n";
}

int print_conformance(const std::string& file, bool as_json, DateTime now, bool has_time_sync)
{
    ControllerConfig config = read_config_or_default(file);
    if (file.empty()) { // the first start creates an account
        config.users.accounts.emplace_back();
        offer_users(config);
    }
    const server::Conformance conformance = conformance_of(std::move(config), now, has_time_sync);
    std::fputs(
        (as_json ? conformance_json(conformance) : describe_conformance(conformance)).c_str(),
        stdout);
    return 0;
}

} // namespace busbar::product
