#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <busbar/storage/folder_storage.hpp>

#include "product/configuration/setting_keys.hpp"
#include "product/configuration/settings.hpp"
#include "product/store/received_program.hpp"
#include "product/store/taken_over.hpp"
#include "support/temporary_folder.hpp"

namespace settings_test {

using namespace busbar;
using namespace busbar::product;
using administration::Setting;
using administration::SettingChange;

namespace {

std::string complaint(const std::function<void()>& act)
{
    try {
        act();
    } catch (const ConfigError& error) {
        return error.what();
    }
    return "nothing";
}

Variant texts(std::initializer_list<const char*> list)
{
    Array<String> array;
    for (const char* text : list) {
        array.push_back(String{text});
    }
    return Variant{std::move(array)};
}

/// A configuration on the disk, and what an administrator changes of it.
struct SettingsFixture {
    SettingsFixture()
    {
        std::filesystem::create_directory(folder.path / "pki");
        write("[server]\nname = \"Press\"\n");
        start();
    }
    /// After the line that says where the changes lie.
    void write(const std::string& rest)
    {
        text = "certificates.folder = \"" + folder.path.string() + "/pki\"\n" + rest;
        std::ofstream{file, std::ios::binary} << text;
    }
    void start() { settings = std::make_unique<Settings>(file); }
    const Setting& find(const std::string& name)
    {
        const Setting* const setting = settings->list().find(name);
        REQUIRE(setting != nullptr);
        return *setting;
    }
    Configured<void> set(std::vector<SettingChange> changes)
    {
        return settings->list().change(changes, *settings);
    }
    std::string refusal(std::vector<SettingChange> changes)
    {
        const auto done = set(std::move(changes));
        return done ? "none" : ::busbar::text(done.error());
    }
    Variant value(const std::string& name) { return settings->value(find(name)); }
    const ControllerConfig& config() { return settings->config(); }

    test::TemporaryFolder folder;
    std::string file{folder.path.string() + "/press.toml"};
    std::string text;
    std::unique_ptr<Settings> settings;
};

} // namespace

TEST_CASE_METHOD(SettingsFixture, "every setting may be what it is by default, and no worse")
{
    CHECK(settings->list().settings().size() > 120);
    for (const Setting& setting : settings->list().settings()) {
        INFO(setting.name);
        if (setting.name != "server.name") {
            CHECK(settings->value(setting) == setting.otherwise);
        }
        CHECK(refusal({{setting.name, setting.otherwise}}) == "none");
        CHECK_FALSE(settings->waits_for_restart(setting));
        CHECK(refusal({{setting.name, Variant{}}}) == "none");
        if (setting.range && !setting.otherwise.is_array()) {
            const bool is_real = setting.otherwise.type() == BuiltInType::Double;
            const double high = setting.range->high + 1;
            const auto past =
                refusal({{setting.name,
                          is_real ? Variant{high} : Variant{static_cast<std::int64_t>(high)}}});
            CHECK(past.find("expected") != std::string::npos);
        }
    }
    CHECK(settings->list().changes().empty());
}

TEST_CASE_METHOD(SettingsFixture, "settings show what the file says, and what was changed")
{
    write("[server]\nname = \"Press\"\nport = 4900\nhost_names = [\"press-4\"]\n"
          "[limits]\nsessions = 7\n[limits.subscriptions]\nsampling_intervals_ms = [10, 50]\n"
          "[[endpoint]]\npolicy = \"Basic256Sha256\"\nmode = \"Sign\"\n"
          "[[plc.variable]]\nname = \"Speed\"\ntype = \"Int16\"\n");
    start();
    CHECK(value("server.name") == Variant{"Press"});
    CHECK(value("server.port") == Variant{std::int64_t{4'900}});
    CHECK(value("server.host_names") == texts({"press-4"}));
    CHECK(value("limits.sessions") == Variant{std::int64_t{7}});
    CHECK(value("limits.subscriptions.sampling_intervals_ms") ==
          Variant{Array<std::int64_t>{10, 50}});
    CHECK(value("endpoint") == texts({"{ mode = 'Sign', policy = 'Basic256Sha256' }"}));
    CHECK(value("plc.variable") == texts({"{ name = 'Speed', type = 'Int16' }"}));
    write("[security]\npolicies = [\"Basic256Sha256\"]\nmode = \"Sign\"\n"
          "[[plc.variable]]\nname = \"Speed\"\ntype = \"Int16\"\n");
    start();
    CHECK(value("endpoint").array_size() == 2);
    // What is shown can be set.
    CHECK(refusal({{"plc.variable", value("plc.variable")}, {"endpoint", value("endpoint")}}) ==
          "none");
    CHECK_FALSE(settings->waits_for_restart(find("plc.variable")));

    CHECK(refusal({{"limits.sessions", Variant{std::int64_t{8}}},
                   {"server.port", Variant{std::int64_t{4'901}}},
                   {"plc.variable", texts({"{ name = \"Force\", type = \"Double\" }",
                                           "{ name = \"Speed\", type = \"Int16\" }"})}}) == "none");
    CHECK(config().server.limits.max_sessions == 8);
    CHECK(config().port == 4'901);
    CHECK(config().plc.variables.size() == 2);
    CHECK(settings->waits_for_restart(find("server.port")));
    CHECK(settings->waits_for_restart(find("plc.variable")));
    CHECK_FALSE(settings->waits_for_restart(find("limits.sessions")));
}

TEST_CASE_METHOD(SettingsFixture, "a set is in force as a whole, or refused with the reason")
{
    struct Row {
        std::vector<SettingChange> set;
        std::string said;
    };
    const Row rows[] = {
        {{{"limits.sessions", Variant{std::int64_t{5}}}, {"server.address", Variant{"here"}}},
         "changed online: address: found 'here', expected an IPv4"},
        {{{"endpoint", texts({"{ policy = \"Basic512\" }"})}},
         "changed online: policy: found 'Basic512', expected one of"},
        {{{"endpoint", texts({"Basic256Sha256"})}}, "endpoint: "},
        {{{"endpoint", texts({"{ policy = \"Basic256Sha256\" }\nusers = { setup = true }"})}},
         "expected { key = value, ... }"},
        {{{"plc.variable", texts({"{ name = \"Speed\", type = \"Int17\" }"})}},
         "changed online: type: found 'Int17'"},
        {{{"limits.sessions", Variant{std::int64_t{100'001}}}},
         "limits.sessions: found 100001, expected 1 to 100000"},
        {{{"limits.sessions", Variant{"many"}}}, "limits.sessions: "},
        {{{"users.account", texts({})}}, "users.account"},
        {{{"certificates.folder", Variant{"/"}}}, "certificates.folder"},
        {{{"limits.preset", Variant{"nj600"}}}, "preset: found 'nj600', expected"},
    };
    for (const Row& row : rows) {
        const std::string said = refusal(row.set);
        INFO(said);
        CHECK(said.find(row.said) != std::string::npos);
        CHECK(settings->list().changes().empty());
        CHECK(config().server.limits.max_sessions == server::ServerLimits{}.max_sessions);
    }
}

TEST_CASE_METHOD(SettingsFixture, "the file is never written, and changes win over it")
{
    CHECK(refusal({{"server.name", Variant{"Lathe"}}, {"limits.preset", Variant{"nj501"}}}) ==
          "none");
    CHECK(config().server.limits.max_sessions == 5);
    CHECK(value("limits.sessions") == Variant{std::int64_t{5}});
    std::ifstream now{file, std::ios::binary};
    CHECK(std::string{std::istreambuf_iterator<char>{now}, {}} == text);
    start();
    CHECK(config().server.application_name == "Lathe");
    CHECK(config().server.limits.max_sessions == 5);

    CHECK(forget_changes(file) ==
          std::vector<std::string>{"the settings that were changed online"});
    start();
    CHECK(config().server.application_name == "Press");
    CHECK(settings->list().changes().empty());
    CHECK(forget_changes(file).empty());
}

TEST_CASE_METHOD(SettingsFixture, "a start says what to do with changes that fit no more")
{
    CHECK(refusal({{"plc.scan_ms", Variant{std::int64_t{5}}},
                   {"plc.variable", texts({"{ name = \"Speed\", type = \"Int16\" }"})}}) == "none");
    write("[[plc.program]]\nkind = \"toggle\"\ntarget = \"Force\"\n"
          "[[plc.variable]]\nname = \"Force\"\ntype = \"Boolean\"\n");
    const std::string said = complaint([&] { start(); });
    INFO(said);
    CHECK(said.find("--forget-changes") != std::string::npos);
    // Mistakes in the file have their line, changes or not.
    write("[limits]\nsessions = 0\n");
    CHECK(complaint([&] { start(); }).find("press.toml:3: sessions: found 0") != std::string::npos);
    write("");
    std::ofstream{folder.path / "pki" / "settings.json"} << "{";
    CHECK(complaint([&] { start(); }).find("settings.json") != std::string::npos);
    forget_changes(file);
    start();
    CHECK(config().scan == std::chrono::milliseconds{20});
}

TEST_CASE_METHOD(SettingsFixture, "a machine in RUN refuses settings that PROGRAM takes (3-2-2, "
                                  "3-2-6)")
{
    std::ofstream{folder.path / "press.st"} << "VAR_GLOBAL Speed : INT; END_VAR\n";
    const std::vector<SettingChange> changes{
        {"server.port", Variant{std::int64_t{4'901}}},
        {"machine.use", Variant{false}},
        {"machine.execution_log", Variant{true}},
        {"machine.execution_log_files", Variant{std::int64_t{7}}},
        {"machine.execution_log_records", Variant{std::int64_t{200}}},
        {"endpoint", texts({"{ mode = 'SignAndEncrypt', policy = 'Aes256_Sha256_RsaPss' }"})},
        {"users.anonymous", Variant{"read"}},
    };
    CHECK(changes.size() == program_only_settings().size());
    const auto write_machine = [&](const std::string& mode) {
        write("[machine]\nprogram = \"" + (folder.path / "press.st").string() + "\"\nmode = \"" +
              mode + "\"\n");
        start();
    };
    write_machine("RUN");
    for (const SettingChange& each : changes) {
        INFO(each.name);
        const auto done = set({{"server.name", Variant{"Lathe"}}, each});
        REQUIRE_FALSE(done);
        CHECK(done.error().status == status::Bad_InvalidState);
        CHECK(done.error().where == each.name);
        CHECK(done.error().text.find("in RUN") != std::string::npos);
        CHECK(config().server.application_name != "Lathe");        // a set is taken as a whole
        CHECK(refusal({{each.name, value(each.name)}}) == "none"); // what it is already
        CHECK(refusal({{each.name, Variant{}}}) == "none");
    }
    // Other settings change, and the mode that it waits for: not in one set.
    CHECK(set({changes[0], {"machine.mode", Variant{"PROGRAM"}}}).error().status ==
          status::Bad_InvalidState);
    CHECK(refusal({{"server.name", Variant{"Lathe"}}, {"machine.mode", Variant{"PROGRAM"}}}) ==
          "none");
    CHECK(refusal({{"machine.mode", Variant{"RUN"}}}) == "none");
    CHECK(set({changes[0]}).error().status == status::Bad_InvalidState);
    CHECK(refusal({{"machine.mode", Variant{"PROGRAM"}}}) == "none");
    CHECK(refusal(changes) == "none");
    forget_changes(file);
    write_machine("PROGRAM");
    CHECK(refusal(changes) == "none");
    forget_changes(file);
    write("[machine]\nmode = \"RUN\"\n"); // there is no program, and no machine
    start();
    CHECK(refusal(changes) == "none");
}

TEST_CASE_METHOD(SettingsFixture, "a file that is read again in RUN has the users and end points "
                                  "that it had (3-2-6)")
{
    std::ofstream{folder.path / "press.st"} << "VAR_GLOBAL Speed : INT; END_VAR\n";
    const auto with = [&](const std::string& mode, const std::string& rest) {
        write("[machine]\nprogram = \"" + (folder.path / "press.st").string() + "\"\nmode = \"" +
              mode + "\"\n" + rest);
    };
    const auto reread = [&] {
        return complaint([&] { settings->read_again([](const auto&) {}); });
    };
    with("RUN", "");
    start();
    for (const char* rest :
         {"[users]\nanonymous = \"read\"\n", "[[endpoint]]\npolicy = \"Basic256Sha256\"\n"}) {
        INFO(rest);
        with("RUN", std::string{"[limits]\nsessions = 7\n"} + rest);
        const std::string said = reread();
        INFO(said);
        CHECK(said.find("cannot change while the machine is in RUN") != std::string::npos);
        CHECK(said.starts_with(file));
        CHECK(config().server.limits.max_sessions != 7); // a file is taken as a whole
        with("PROGRAM", rest);
        CHECK(reread() == "nothing");
        with("PROGRAM", "");
        CHECK(reread() == "nothing");
        with("RUN", "");
        CHECK(reread() == "nothing");
    }
    with("RUN", "[limits]\nsessions = 7\n");
    CHECK(reread() == "nothing");
    CHECK(config().server.limits.max_sessions == 7);
}

TEST_CASE_METHOD(SettingsFixture, "a program that was sent is forgotten with the settings")
{
    const std::string pki = folder.path.string() + "/pki";
    const std::string place = pki + "/program.received";
    storage::FolderStorage storage{pki};
    const auto send = [&] {
        const std::string sent =
            document_of({.name = "sent.st", .text = "VAR_GLOBAL Speed : INT; END_VAR\n"});
        REQUIRE(keep_received(storage, sent));
        TakenOver ran;
        ran.files.emplace(file, std::make_shared<const std::string>(text));
        ran.files.emplace(storage.place("program.received"),
                          std::make_shared<const std::string>(sent));
        REQUIRE(TakenOverFiles{storage}.keep(ran));
    };
    write("[machine]\nprogram = \"" + (folder.path / "press.st").string() + "\"\n");
    // The files alone make no controller: what it ran with last stays to start with.
    send();
    forget_changes(file);
    CHECK_FALSE(std::filesystem::exists(place));
    CHECK(TakenOverFiles{storage}.read()->files.size() == 2);
    std::ofstream{folder.path / "press.st"} << "VAR_GLOBAL Speed : INT; END_VAR\n";
    send();
    forget_changes(file);
    CHECK_FALSE(std::filesystem::exists(place));
    CHECK(TakenOverFiles{storage}.read()->files.size() == 1);
    start();
    CHECK(config().machine.program_name == config().machine.program_file);
}

TEST_CASE_METHOD(SettingsFixture, "the last endpoint for administration cannot go")
{
    write("[[endpoint]]\npolicy = \"Basic256Sha256\"\nmode = \"SignAndEncrypt\"\n");
    start();
    for (const char* open :
         {"{ policy = 'None' }", "{ mode = 'Sign', policy = 'Basic256Sha256' }"}) {
        INFO(open);
        const auto done = set({{"endpoint", texts({open})}});
        REQUIRE_FALSE(done);
        CHECK(done.error().status == status::Bad_InvalidArgument);
        CHECK(done.error().where == "endpoint");
        CHECK(done.error().text.find("SignAndEncrypt") != std::string::npos);
    }
    CHECK(refusal({{"endpoint",
                    texts({"{ policy = 'None' }",
                           "{ mode = 'SignAndEncrypt', policy = 'Aes256_Sha256_RsaPss' }"})}}) ==
          "none");
    // Where there is none it was decided at the machine.
    forget_changes(file);
    write("[[endpoint]]\npolicy = \"None\"\n");
    start();
    CHECK(refusal({{"endpoint", texts({"{ mode = 'Sign', policy = 'Basic256Sha256' }"})}}) ==
          "none");
}

TEST_CASE_METHOD(SettingsFixture, "what runs is asked before a change and told after it")
{
    std::vector<std::size_t> asked;
    std::vector<std::size_t> told;
    std::string reason;
    settings->run({.check = [&](const ControllerConfig& next) -> Configured<void> {
                       asked.push_back(next.server.limits.max_sessions);
                       return reason.empty() ? Configured<void>{} : misconfigured("limits", reason);
                   },
                   .apply =
                       [&](const ControllerConfig& next) {
                           told.push_back(next.server.limits.max_sessions);
                       }});
    CHECK(refusal({{"limits.sessions", Variant{std::int64_t{9}}}}) == "none");
    CHECK(asked == std::vector<std::size_t>{9});
    CHECK(told == asked);
    reason = "found too little memory";
    CHECK(refusal({{"limits.sessions", Variant{std::int64_t{10}}}}).find(reason) !=
          std::string::npos);
    CHECK(value("limits.sessions") == Variant{std::int64_t{9}});
    // The file is read again: what was changed stays over it.
    write("[limits]\nsessions = 11\npending_requests = 3\n");
    const auto any = [](const ControllerConfig&) {};
    CHECK(complaint([&] { settings->read_again(any); }).find(reason) != std::string::npos);
    CHECK(told.size() == 1);
    reason.clear();
    const auto refuses = [](const ControllerConfig&) { throw ConfigError{"x", "not this one"}; };
    CHECK(complaint([&] { settings->read_again(refuses); }).find("not this one") !=
          std::string::npos);
    CHECK(told.size() == 1);
    settings->read_again(any);
    CHECK(told == std::vector<std::size_t>{9, 9});
    CHECK(refusal({{"limits.sessions", Variant{}}}) == "none");
    CHECK(told.back() == 11);
}

} // namespace settings_test
