#include <busbar/harness/world.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string_view>
#include <utility>

#include <busbar/harness/report.hpp>

namespace busbar::harness {

namespace {

/// The worlds of all threads, for the account of a test that fails.
struct Worlds {
    std::mutex mutex;
    std::vector<const World*> all;
    FailTest on_failure{nullptr};
};

Worlds& worlds()
{
    static Worlds known;
    return known;
}

/// Returns the text with each line moved to the right, after a title; empty if there is none.
std::string section(std::string_view title, std::string_view text)
{
    std::string moved;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        moved.append("    ").append(text.substr(0, end)).append("\n");
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return moved.empty() ? moved : "  " + std::string{title} + ":\n" + moved;
}

} // namespace

FailTest set_fail_test(FailTest fail_test)
{
    return std::exchange(worlds().on_failure, fail_test);
}

std::string account_of_worlds(std::size_t lines)
{
    Worlds& known = worlds();
    const std::lock_guard lock{known.mutex};
    std::string text;
    for (const World* const world : known.all) {
        text += world->account(lines);
    }
    return text;
}

void fail_test(const std::string& why)
{
    const FailTest on_failure = worlds().on_failure;
    if (on_failure != nullptr && std::uncaught_exceptions() == 0) {
        on_failure(why);
    }
}

World::World(std::uint64_t seed, DateTime begin) : seed_{seed}, clock_{scheduler_, begin}
{
    Worlds& known = worlds();
    const std::lock_guard lock{known.mutex};
    known.all.push_back(this);
}

World::~World()
{
    {
        Worlds& known = worlds();
        const std::lock_guard lock{known.mutex};
        known.all.erase(std::remove(known.all.begin(), known.all.end(), this), known.all.end());
    }
    if (const std::string pending = network_.pending_faults();
        !pending.empty() && !network_.forgives_pending_faults()) {
        fail_test("faults that have never acted, so that the test proves nothing of them "
                  "(Network::forgive_pending_faults() if that is meant):\n" +
                  pending + account());
    }
}

LogSink& World::new_log(Actor kind)
{
    static constexpr std::array<std::string_view, 3> names{"server", "client", "other"};
    const auto index = static_cast<std::size_t>(kind);
    std::string name{names.at(index)};
    if (const std::size_t number = ++speakers_.at(index); number > 1) {
        name += " " + std::to_string(number);
    }
    return new_log(std::move(name));
}

LogSink& World::new_log(std::string name)
{
    return *logs_.emplace_back(std::make_unique<Speaker>(log_, std::move(name)));
}

std::string World::account(std::size_t lines) const
{
    return "the world with seed " + std::to_string(seed_) +
           ", which BUSBAR_SEED=" + std::to_string(seed_) + " repeats, at " +
           text_of(now().time_since_epoch()) + "\n" +
           section("the last lines of its log", log_.last(lines)) +
           section("the last messages", trace(lines));
}

std::uint64_t World::seed_from_environment()
{
    std::uint64_t seed = 1;
    if (const char* const variable = std::getenv("BUSBAR_SEED")) {
        const std::string_view text{variable};
        std::from_chars(text.data(), text.data() + text.size(), seed);
    }
    return seed;
}

} // namespace busbar::harness
