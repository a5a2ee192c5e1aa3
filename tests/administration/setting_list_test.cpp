#include <busbar/administration/setting_list.hpp>

#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace setting_list_test {

using namespace busbar;
using administration::Setting;
using administration::SettingAuthor;
using administration::SettingAuthors;
using administration::SettingChange;
using administration::SettingList;
using administration::SettingValues;

namespace {

/// Has no more than ten sessions for each of its hosts.
struct Owner final : administration::SettingOwner {
    [[nodiscard]] Variant value(const Setting& setting) const override
    {
        const auto found = applied.find(setting.name);
        return found == applied.end() ? setting.otherwise : found->second;
    }
    [[nodiscard]] bool waits_for_restart(const Setting&) const override { return false; }
    [[nodiscard]] Configured<void> check(const SettingValues& changes) override
    {
        ++checks;
        const auto found = changes.find("limits.sessions");
        if (found != changes.end() && found->second == Variant{std::int64_t{13}}) {
            return misconfigured("limits.sessions", "found 13, expected luck");
        }
        return {};
    }
    void apply(const SettingValues& changes) override { applied = changes; }

    SettingValues applied;
    int checks{0};
};

std::vector<Setting> settings()
{
    return {
        {.name = "limits.sessions",
         .otherwise = Variant{std::int64_t{100}},
         .range = Range{1, 1'000}},
        {.name = "server.name", .otherwise = Variant{"Press 4"}},
        {.name = "server.host_names", .otherwise = Variant{Array<String>{"press-4"}}},
        {.name = "limits.intervals_ms",
         .otherwise = Variant{Array<std::int64_t>{100}},
         .range = Range{1, 500},
         .unit = "ms"},
        {.name = "limits.overload", .otherwise = Variant{5.0}, .range = Range{0, 100}, .unit = "%"},
        {.name = "server.auditing", .otherwise = Variant{false}}};
}

struct SettingFixture {
    SettingFixture() { REQUIRE(list.load()); }

    std::string change(std::string name, Variant value)
    {
        const SettingChange set[] = {{std::move(name), std::move(value)}};
        return change(set);
    }
    std::string change(std::span<const SettingChange> set)
    {
        const auto changed = list.change(set, owner);
        return changed ? "Good" : text(changed.error());
    }
    /// What a program finds that starts anew.
    [[nodiscard]] SettingValues stored()
    {
        SettingList again{storage, "settings.json", settings()};
        REQUIRE(again.load());
        return again.changes();
    }
    void write(const std::string& document)
    {
        REQUIRE(storage.replace("settings.json", std::as_bytes(std::span{document}),
                                FileAccess::Owner));
    }

    storage::MemoryStorage storage;
    Owner owner;
    SettingList list{storage, "settings.json", settings()};
};

} // namespace

TEST_CASE_METHOD(SettingFixture, "settings: a set is kept, whole, and in force")
{
    const SettingChange set[] = {
        {"limits.sessions", Variant{std::int64_t{7}}},
        {"limits.overload", Variant{2.5}},
        {"limits.intervals_ms", Variant{Array<std::int64_t>{1, 500}}},
        {"server.auditing", Variant{true}},
        {"server.name", Variant{"Pr\xC3\xA4gung \"4\""}},
        {"server.host_names", Variant{Array<String>{"a", "b"}}},
    };
    CHECK(change(set) == "Good");
    CHECK(owner.checks == 1);
    CHECK(owner.applied.size() == 6);
    CHECK(stored() == owner.applied);
    CHECK(stored() == list.changes());
    CHECK(owner.value(*list.find("server.name")) == Variant{"Pr\xC3\xA4gung \"4\""});
    // Null takes a change back, and the last of two of one name wins.
    const SettingChange back[] = {{"server.auditing", Variant{}},
                                  {"limits.sessions", Variant{std::int64_t{8}}},
                                  {"limits.sessions", Variant{std::int64_t{9}}}};
    CHECK(change(back) == "Good");
    CHECK(owner.value(*list.find("server.auditing")) == Variant{false});
    CHECK(owner.value(*list.find("limits.sessions")) == Variant{std::int64_t{9}});
    CHECK(stored() == owner.applied);
    REQUIRE(list.forget());
    CHECK(list.changes().empty());
    CHECK(stored().empty());
    REQUIRE(list.forget());
}

TEST_CASE_METHOD(SettingFixture, "settings: a document of changes is what a list keeps and reads")
{
    const SettingChange set[] = {{"server.name", Variant{"Press"}},
                                 {"limits.intervals_ms", Variant{Array<std::int64_t>{1, 500}}}};
    CHECK(change(set) == "Good");
    const auto kept = read_file(storage, "settings.json", 1'000);
    REQUIRE(kept);
    const std::string document = administration::settings_document(list.changes());
    CHECK(document == std::string{reinterpret_cast<const char*>(kept->data()), kept->size()});
    const SettingValues part{{"server.name", Variant{"Lathe"}}};
    write(administration::settings_document(part));
    CHECK(stored() == part);
    write(administration::settings_document({}));
    CHECK(stored().empty());
}

TEST_CASE_METHOD(SettingFixture, "settings: what is wrong is refused with the reason")
{
    CHECK(change("limits.sessions", Variant{std::int64_t{7}}) == "Good");
    const auto kept = stored();
    struct Case {
        const char* name;
        Variant value;
        const char* reason;
    };
    const Case cases[] = {
        {"limits.sessions", Variant{std::int64_t{0}},
         "limits.sessions: found 0, expected 1 to 1000"},
        {"limits.sessions", Variant{std::int64_t{1'001}}, "found 1001, expected 1 to 1000"},
        {"limits.sessions", Variant{std::int32_t{5}}, "expected a whole number"},
        {"limits.sessions", Variant{std::int64_t{13}}, "expected luck"},
        {"limits.sessions", Variant{Array<std::int64_t>{5}}, "found [5], expected a whole number"},
        {"limits.intervals_ms", Variant{Array<std::int64_t>{5, 501}}, "expected 1 to 500 ms"},
        {"limits.intervals_ms", Variant{std::int64_t{5}}, "expected a list of whole numbers"},
        {"limits.overload", Variant{100.5}, "expected 0 to 100 %"},
        {"limits.overload", Variant{std::nan("")}, "expected a number"},
        {"limits.overload", Variant{std::numeric_limits<double>::infinity()}, "expected a number"},
        {"server.auditing", Variant{"true"}, "found \"true\", expected true or false"},
        {"server.name", Variant{String{std::string(65'537, 'x')}}, "65536 bytes"},
        {"server.host_names", Variant{Array<String>{String{std::string{"a\0b", 3}}}}, "not UTF-8"},
        {"server.host_names", Variant{Array<String>{"a", "\xC3"}}, "not UTF-8"},
        {"server.host_names", Variant{Array<String>(1'001)}, "1000 elements"},
        {"server.nam", Variant{"x"}, "server.nam: there is no such setting"},
    };
    for (const Case& each : cases) {
        const std::string reason = change(each.name, each.value);
        INFO(reason);
        CHECK(reason.find(each.reason) != std::string::npos);
    }
    // One that is wrong takes the others with it.
    const SettingChange set[] = {{"server.name", Variant{"Press 5"}},
                                 {"limits.sessions", Variant{std::int64_t{0}}}};
    CHECK(change(set).find("limits.sessions") == 0);
    CHECK(stored() == kept);
    CHECK(owner.applied == kept);
    CHECK(list.changes() == kept);
}

TEST_CASE_METHOD(SettingFixture, "settings: who changed one, and when, is kept with it")
{
    const SettingAuthor pat{"p\xC3\xA4t \"4\"", DateTime::from_unix_seconds(1'000'000)};
    const SettingAuthor sam{"", DateTime::from_unix_seconds(2'000'000)};
    const SettingChange both[] = {{"server.name", Variant{"a"}},
                                  {"server.auditing", Variant{true}}};
    REQUIRE(list.change(both, owner, pat));
    const SettingChange one[] = {{"server.name", Variant{"b"}}};
    REQUIRE(list.change(one, owner, sam));
    const SettingAuthors expected{{"server.auditing", pat}, {"server.name", sam}};
    CHECK(list.authors() == expected);
    SettingList again{storage, "settings.json", settings()};
    REQUIRE(again.load());
    CHECK(again.authors() == expected);
    // With a change goes its author; one that nobody is told of has none.
    const SettingChange back[] = {{"server.auditing", Variant{}}, {"server.name", Variant{"c"}}};
    REQUIRE(list.change(back, owner));
    CHECK(list.authors().empty());
    REQUIRE(again.load());
    CHECK(again.authors().empty());
}

TEST_CASE_METHOD(SettingFixture, "settings: a file without authors, or with damaged ones, is read")
{
    for (const char* more :
         {"", ",\"authors\":7", ",\"authors\":{\"server.name\":{\"user\":\"x\"}}",
          ",\"authors\":{\"server.name\":{\"user\":\"x\",\"time\":\"noon\"}}"}) {
        INFO(more);
        write(std::string{"{\"version\":1,\"settings\":{\"server.name\":\"a\"}"} + more + "}");
        REQUIRE(list.load());
        CHECK(list.changes().size() == 1);
        CHECK(list.authors().empty());
    }
}

TEST_CASE_METHOD(SettingFixture, "settings: what waits for a restart is not changed before")
{
    StorageGate gate{storage};
    SettingList gated{gate, "settings.json", settings()};
    REQUIRE(gated.load());
    gate.close();
    const SettingChange set[] = {{"limits.sessions", Variant{std::int64_t{7}}}};
    const auto done = gated.change(set, owner);
    REQUIRE_FALSE(done);
    CHECK(done.error().status == status::Bad_InvalidState);
    CHECK(gated.changes().empty());
    CHECK(owner.applied.empty());
}

TEST_CASE_METHOD(SettingFixture, "settings: a disk that is full leaves all as it was")
{
    CHECK(change("limits.sessions", Variant{std::int64_t{7}}) == "Good");
    const auto kept = owner.applied;
    const auto refused = [&] {
        return change("limits.sessions", Variant{std::int64_t{8}})
                   .find("Bad_ResourceUnavailable") != std::string::npos;
    };
    storage.set_capacity(0);
    CHECK(refused());
    storage.set_capacity(1'000'000);
    storage.set_protected(true);
    CHECK(refused());
    storage.set_protected(false);
    storage.set_away(true);
    CHECK(refused());
    storage.set_away(false);
    CHECK(owner.applied == kept);
    CHECK(stored() == kept);
}

TEST_CASE("settings: a power cut at any step leaves the old set or the new one")
{
    const SettingChange old_set[] = {{"server.name", Variant{"old"}},
                                     {"server.auditing", Variant{true}}};
    const SettingChange new_set[] = {{"server.name", Variant{"new"}},
                                     {"server.auditing", Variant{}}};
    std::size_t was_kept = 0;
    std::size_t was_lost = 0;
    for (std::size_t steps = 0; was_kept < 3; ++steps) {
        SettingFixture fixture;
        REQUIRE(fixture.change(old_set) == "Good");
        const SettingValues before = fixture.stored();
        fixture.storage.cut_power_after(steps);
        const bool was_acknowledged = fixture.change(new_set) == "Good";
        fixture.storage.restore_power();
        const SettingValues after = fixture.stored();
        INFO(steps);
        CHECK((was_acknowledged ? after != before : true));
        CHECK((after == before || after == SettingValues{{"server.name", Variant{"new"}}}));
        ++(after == before ? was_lost : was_kept);
        REQUIRE(steps < 1'000);
    }
    CHECK(was_lost > 20);
}

TEST_CASE_METHOD(SettingFixture, "settings: a file with a mistake is named and not used")
{
    struct Case {
        const char* document;
        const char* reason;
    };
    const Case cases[] = {
        {"{\"version\":1}", "settings: found nothing, expected an object"},
        {"{\"version\":1,\"settings\":{\"limits.sessions\":\"7\"}}",
         "settings.limits.sessions: found \"7\", expected a whole number"},
        {"{\"version\":1,\"settings\":{\"limits.sessions\":7.5}}", "expected a whole number"},
        {"{\"version\":1,\"settings\":{\"limits.sessions\":0}}", "expected 1 to 1000"},
        {"{\"version\":1,\"settings\":{\"server.host_names\":[\"a\",1]}}", "a list of texts"},
        {"{\"version\":1,\"settings\":{\"limits.none\":0}}", "expected the name of a setting"},
        {"{\"version\":2,\"settings\":{}}", "version: found 2, expected 1"},
    };
    for (const Case& each : cases) {
        write(each.document);
        const auto loaded = list.load();
        INFO(each.document);
        REQUIRE_FALSE(loaded);
        INFO(text(loaded.error()));
        CHECK(text(loaded.error()).find("settings.json") != std::string::npos);
        CHECK(text(loaded.error()).find(each.reason) != std::string::npos);
        CHECK(list.changes().empty());
    }
}

namespace {

/// Lists of what has no list among the settings above.
struct ListFixture {
    ListFixture() { REQUIRE(list.load()); }

    std::string change(const char* name, Variant value)
    {
        const SettingChange set[] = {{name, std::move(value)}};
        const auto changed = list.change(set, owner);
        return changed ? "Good" : text(changed.error());
    }
    std::string load(const std::string& value_text)
    {
        const std::string document = R"({"version":1,"settings":{)" + value_text + "}}";
        REQUIRE(storage.replace("settings.json", std::as_bytes(std::span{document}),
                                FileAccess::Owner));
        const auto loaded = list.load();
        return loaded ? "Good" : text(loaded.error());
    }

    storage::MemoryStorage storage;
    Owner owner;
    SettingList list{storage,
                     "settings.json",
                     {{.name = "gains",
                       .otherwise = Variant{Array<double>{1.0}},
                       .range = Range{0.25, 4.5},
                       .unit = "%"},
                      {.name = "flags", .otherwise = Variant{Array<bool>{true}}}}};
};

} // namespace

TEST_CASE_METHOD(ListFixture, "settings: lists of numbers and of flags are kept and checked")
{
    const Variant gains{Array<double>{0.25, 4.5}};
    const Variant flags{Array<bool>{false, true}};
    CHECK(change("gains", gains) == "Good");
    CHECK(change("flags", flags) == "Good");
    const auto known = list.settings();
    SettingList again{storage, "settings.json", {known.begin(), known.end()}};
    REQUIRE(again.load());
    CHECK(again.changes() == SettingValues{{"gains", gains}, {"flags", flags}});
    CHECK(change("gains", Variant{Array<double>{1.0, 4.75}}).find("expected 0.25 to 4.5 %") !=
          std::string::npos);
    CHECK(change("gains", Variant{Array<double>{1.0, std::nan("")}})
              .find("expected a list of numbers") != std::string::npos);
    CHECK(change("gains", Variant{1.0}).find("found 1, expected a list of numbers") !=
          std::string::npos);
    CHECK(change("flags", Variant{false}).find("found false, expected a list of true and false") !=
          std::string::npos);
    CHECK(list.changes() == again.changes());
}

TEST_CASE_METHOD(ListFixture, "settings: a file with a mistake in a list is named and not used")
{
    const std::string numbers = "expected a list of numbers";
    for (const char* wrong : {"1", "\"1\"", "[true]", "[1,\"2\"]", "[1e999]", "[[1]]", "null"}) {
        INFO(wrong);
        CHECK(load(R"("gains":)" + std::string{wrong}).find(numbers) != std::string::npos);
    }
    CHECK(load(R"("gains":[5])").find("expected 0.25 to 4.5 %") != std::string::npos);
    for (const char* wrong : {"true", "[1]", "[true,\"true\"]", "{}"}) {
        INFO(wrong);
        CHECK(load(R"("flags":)" + std::string{wrong}).find("a list of true and false") !=
              std::string::npos);
    }
    CHECK(list.changes().empty());
    CHECK(load(R"("gains":[],"flags":[])") == "Good");
    CHECK(list.changes().size() == 2);
}

TEST_CASE_METHOD(SettingFixture, "settings: what cannot be forgotten stays in force")
{
    CHECK(change("limits.sessions", Variant{std::int64_t{7}}) == "Good");
    storage.set_protected(true);
    const auto forgotten = list.forget();
    REQUIRE_FALSE(forgotten);
    CHECK(forgotten.error().status == status::Bad_ResourceUnavailable);
    CHECK(list.changes().size() == 1);
    storage.set_protected(false);
    CHECK(stored() == list.changes());
    write(R"({"version":1,"settings":[]})");
    const auto loaded = list.load();
    REQUIRE_FALSE(loaded);
    CHECK(text(loaded.error()).find("settings: found a list, expected an object") !=
          std::string::npos);
    REQUIRE(storage.remove("settings.json"));
    REQUIRE(storage.make_folder("settings.json", FileAccess::Owner));
    CHECK_FALSE(list.load());
    CHECK(list.changes().size() == 1);
}

TEST_CASE_METHOD(SettingFixture, "settings: a file that is gone is no changes")
{
    CHECK(change("limits.sessions", Variant{std::int64_t{7}}) == "Good");
    REQUIRE(storage.remove("settings.json"));
    CHECK(list.load());
    CHECK(list.changes().empty());
}

} // namespace setting_list_test
