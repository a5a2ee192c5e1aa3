#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/worst_case_memory.hpp>

#include "product/configuration/limit_keys.hpp"
#include "product/configuration/presets.hpp"
#include "product/configuration/setting_keys.hpp"
#include "product/printing/describe.hpp"

namespace print_limits_test {

using namespace busbar;
using product::describe_limits;

namespace {

product::ControllerConfig parse(const std::string& text)
{
    return product::parse_config(text, "plant.toml");
}

std::vector<std::string> lines_of(const std::string& text)
{
    std::vector<std::string> lines;
    std::istringstream in{text};
    for (std::string line; std::getline(in, line);) {
        lines.push_back(line);
    }
    return lines;
}

/// The words of the line that begins with the limit's name.
std::vector<std::string> words_of(const std::string& text, const std::string& limit)
{
    std::vector<std::string> words;
    for (const std::string& line : lines_of(text)) {
        std::istringstream in{line};
        if (words.empty() && line.starts_with(limit + " ")) {
            for (std::string word; in >> word;) {
                words.push_back(word);
            }
        }
    }
    return words;
}

} // namespace

TEST_CASE("all limits are printed with what they cost")
{
    const product::ControllerConfig config = parse("");
    const std::string text = describe_limits(config);
    for (const server::MemoryRow& row : server::worst_case_memory(config.server.limits).rows) {
        INFO(row.limit);
        CHECK(words_of(text, std::string{row.limit}).size() >= 2);
    }
    const auto lines = lines_of(text);
    REQUIRE(lines.size() > 80);
    CHECK(lines.front().starts_with("limit "));
    CHECK(lines.back().starts_with("in all, at worst "));
    // In columns: what is held begins at one place everywhere.
    const std::size_t column = lines.front().find("what is held");
    for (const std::string& line : lines) {
        CHECK((line.size() <= column || (line[column - 1] == ' ' && line[column] != ' ')));
    }
}

TEST_CASE("a limit of the file is printed with its key")
{
    const std::string text = describe_limits(parse("[limits]\nsessions = 7\n"));
    CHECK(words_of(text, "max_sessions")[1] == "7");
    CHECK(words_of(text, "max_sessions")[2] == "sessions");
    CHECK(words_of(text, "max_session_memory")[2] == "B");
    CHECK(words_of(text, "max_session_memory")[3] == "session_memory");
    CHECK(words_of(text, "max_session_memory")[4] == "448.0"); // 7 times 64 MiB
    CHECK(words_of(text, "max_session_memory")[5] == "MiB");
    CHECK(words_of(text, "send_timeout") ==
          std::vector<std::string>{"send_timeout", "30000", "ms", "send_timeout_ms"});
}

TEST_CASE("each limit that clients are held to has a key")
{
    for (const server::MemoryRow& row : server::worst_case_memory({}).rows) {
        if (row.limit.find("::") != std::string_view::npos) {
            continue; // a cost that comes with something else, and no limit
        }
        const std::string key = product::key_of(row.limit);
        // The value that is in force is one that may be set.
        const std::string text = "[limits]\n" + key + " = " + std::to_string(row.value) + "\n";
        INFO(row.limit << ": " << text);
        REQUIRE_FALSE(key.empty());
        CHECK(words_of(describe_limits(parse(text)), std::string{row.limit})[1] ==
              std::to_string(row.value));
    }
    CHECK(product::key_of("max_nothing").empty());
}

TEST_CASE("each row of the table of limits is in each of its uses")
{
    const auto with = [](const product::LimitKey& key, std::int64_t value) {
        return "[" + std::string{key.table} + "]\n" + std::string{key.name} + " = " +
               std::to_string(value) + "\n";
    };
    const product::ControllerConfig otherwise = parse("");
    const auto settings = product::controller_settings(product::parse_table("", "plant.toml"));
    for (const product::LimitKey& key : product::limit_keys()) {
        const std::string name = product::setting_name(key);
        const std::int64_t value = key.get(otherwise);
        INFO(name << ": " << value);
        CHECK(product::find_limit(name) == &key);
        // A key of the file with its range.
        CHECK(value >= key.least);
        CHECK(value <= key.most);
        CHECK(key.get(parse(with(key, value))) == value);
        CHECK_THROWS_WITH(parse(with(key, key.most + 1)),
                          Catch::Contains("plant.toml:2: " + std::string{key.name} + ": found "));
        CHECK_THROWS_WITH(parse(with(key, key.least - 1)), Catch::Contains("expected a number"));
        // The member is its own: nobody else's number changes with it.
        const std::int64_t another = value > key.least ? value - 1 : value + 1;
        product::ControllerConfig changed = otherwise;
        key.set(changed, another);
        for (const product::LimitKey& each : product::limit_keys()) {
            CHECK(each.get(changed) == (&each == &key ? another : each.get(otherwise)));
        }
        // A setting.
        const auto setting = std::ranges::find(settings, name, &administration::Setting::name);
        REQUIRE((setting != settings.end()) == key.is_setting);
        if (key.is_setting) {
            CHECK(setting->otherwise == Variant{value});
            CHECK(setting->range->low == static_cast<double>(key.least));
            CHECK(setting->range->high == static_cast<double>(key.most));
            CHECK(setting->unit == key.unit);
            CHECK(setting->is_security == key.is_security);
            CHECK(product::is_live(name) == key.is_live);
        }
        // What it costs, the document of capacities and presets.
        if (!key.cost.empty()) {
            CHECK("limits." + product::key_of(key.cost) == name);
            CHECK(words_of(describe_limits(changed), std::string{key.cost})[1] ==
                  std::to_string(another));
        }
        const std::string capacities = product::describe_capacities(changed);
        CHECK((capacities.find("`" + product::key_of(key.cost) + "`") != std::string::npos) ==
              (key.capacity.place != 0));
        if (key.figure.place != 0) {
            CHECK(product::preset_json(*product::find_preset("nj501"))
                      .find("\"" + std::string{key.figure.name} + "\":") != std::string::npos);
        }
    }
}

TEST_CASE("documents have each place once")
{
    for (const auto document : {&product::LimitKey::capacity, &product::LimitKey::figure}) {
        std::set<int> places;
        for (const product::LimitKey* const key : product::limits_in(document)) {
            CHECK(places.insert((key->*document).place).second);
        }
        CHECK(places.size() > 20);
    }
}

TEST_CASE("limits that are no numbers")
{
    const product::ControllerConfig config =
        parse("[limits.subscriptions]\nsamples_each_scan = false\n"
              "sampling_intervals_ms = [100, 250]\noverload_percent = 5\n"
              "[limits.certificates]\nwhen_rejected_is_full = \"discard\"\n"
              "[users.passwords]\nneeds_letters_and_digit = true\nname_characters = \"abc\"\n"
              "password_characters = \"abcABC123\"\nreserved_names = [\"root\"]\n");
    const server::SamplingPolicy& sampling = config.server.limits.subscriptions.sampling;
    CHECK_FALSE(sampling.samples_each_scan);
    CHECK(sampling.intervals ==
          std::vector{std::chrono::milliseconds{100}, std::chrono::milliseconds{250}});
    CHECK(sampling.overload_percent == 5);
    CHECK(config.certificates.limits.when_rejected_is_full == crypto::RejectedFull::Discard);
    const server::PasswordRules& rules = config.users.password_rules;
    CHECK(server::check_user_name(rules, "cab"));
    CHECK_FALSE(server::check_user_name(rules, "cad"));
    CHECK_FALSE(server::check_password(rules, "cab", "abcabcabcabc"));
    CHECK(server::check_password(rules, "cab", "abcABC123123"));
    CHECK_THROWS_WITH(parse("[limits.subscriptions]\nsampling_intervals_ms = [2, 1]"),
                      Catch::Contains("ascending order"));
    CHECK_THROWS_WITH(parse("[limits.certificates]\nwhen_rejected_is_full = \"panic\""),
                      Catch::Contains("\"oldest out\" or \"discard\""));
    CHECK_THROWS_WITH(parse("[users.passwords]\nmin_password_length = 64\n"
                            "max_password_length = 63"),
                      Catch::Contains("not above the maximum"));
}

TEST_CASE("passwords cost memory only where there are some")
{
    product::ControllerConfig config = parse("[users]\nanonymous = \"read\"\n");
    const std::string row = "MemoryAssumptions::password_cost";
    CHECK(words_of(describe_limits(config), row)[3] != "16.0");
    config.users.accounts.emplace_back();
    CHECK(words_of(describe_limits(config), row)[3] == "16.0");

    // The costliest hash counts, whether there is one or one will be made.
    config.users.password_rules.cost.scheme = crypto::PasswordScheme::Pbkdf2;
    CHECK(words_of(describe_limits(config), row)[1] == "2048");
    config.users.accounts.front().password_hash = "$scrypt$15$8$1$AAAAAAAAAAAAAAAAAAAAAA==$"
                                                  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=";
    CHECK(words_of(describe_limits(config), row)[3] == "32.0");
}

TEST_CASE("memory is one number from which the limits come")
{
    const auto total = [](const product::ControllerConfig& config) {
        return product::worst_case_of(config).total();
    };
    const auto with = [](const std::string& memory) {
        return "[users]\npassword_hash = \"pbkdf2\"\n[limits]\nmemory = \"" + memory + "\"\n";
    };
    for (const char* memory : {"64 MB", "256MiB", "1 GB", "900 GB"}) {
        CAPTURE(memory);
        CHECK(total(parse(with(memory))) > 0);
    }
    CHECK(total(parse(with("64 MB"))) <= 64'000'000);
    CHECK(total(parse(with("64 MB"))) > 55'000'000);
    CHECK(total(parse(with("900 GB"))) == total(parse("[users]\npassword_hash = \"pbkdf2\"\n")));
    // The check of a password with the default's cost is part of it.
    CHECK(total(parse("[limits]\nmemory = \"64 MB\"\n")) < 64'000'000 - 16'000'000);

    // Other keys win, as long as it is kept.
    const auto config = parse(with("64 MB") + "sessions = 4\n");
    CHECK(config.server.limits.max_sessions == 4);
    CHECK_THROWS_WITH(
        parse(with("64 MB") + "send_queue = 16777216\n"),
        Catch::StartsWith("plant.toml:4: memory: found 61.0 MiB and other limits with "
                          "which clients can take "));
    CHECK_THROWS_WITH(parse(with("2 MB")),
                      Catch::StartsWith("plant.toml:4: memory: found 1.9 MiB, expected at least "));
    CHECK_THROWS_WITH(parse("[limits]\nmemory = \"8 MB\"\n"),
                      Catch::Contains("of which the check of a password takes 16.0 MiB"));
    for (const char* wrong : {"64", "MB", "-1 MB", "64 TB", "1 kB", "64 MBit", "1025 GB", ""}) {
        CAPTURE(wrong);
        CHECK_THROWS_WITH(parse(with(wrong)), Catch::Contains("expected a size from \"1 MB\""));
    }
    CHECK_THROWS_WITH(parse("[limits]\nmemory = 64\n"), Catch::Contains("plant.toml:2"));
}

TEST_CASE("sizes are printed as people read them")
{
    CHECK(product::size_text(0) == "0 B");
    CHECK(product::size_text(1'023) == "1023 B");
    CHECK(product::size_text(1'024) == "1.0 KiB");
    CHECK(product::size_text(1'048'575) == "1.0 MiB");
    CHECK(product::size_text(std::uint64_t{3} << 29U) == "1.5 GiB");
    CHECK(product::size_text(UINT64_MAX - 1) == "16.0 EiB");
    CHECK(product::size_text(UINT64_MAX) == "no end");
}

TEST_CASE("capacities are those of the configuration")
{
    CHECK(product::describe_capacities(parse("")).find("| Sessions | 100 | `sessions` |\n") !=
          std::string::npos);
    CHECK(product::describe_capacities(parse("[limits]\nsessions = 7\n"))
              .find("| Sessions | 7 | `sessions` |") != std::string::npos);
}

} // namespace print_limits_test
