#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "harness_names.hpp"

namespace busbar::test {

/// What happened in a simulation: a hash of all of it, and what must not have happened.
class Trace {
public:
    explicit Trace(const Scheduler& scheduler)
        : scheduler_{&scheduler}, prints_{std::getenv("BUSBAR_SIMULATION_TRACE") != nullptr}
    {
    }

    void note(std::uint64_t actor, std::string_view what, std::uint64_t a = 0, std::uint64_t b = 0)
    {
        const auto time = static_cast<std::uint64_t>(scheduler_->now().time_since_epoch().count());
        for (const std::uint64_t number : {time, actor, a, b}) {
            add(number);
        }
        for (const char c : what) {
            add(static_cast<unsigned char>(c));
        }
        ++notes_;
        if (prints_) {
            std::fprintf(stderr, "%s %.*s %llu %llu\n", line_start(actor).c_str(),
                         static_cast<int>(what.size()), what.data(),
                         static_cast<unsigned long long>(a), static_cast<unsigned long long>(b));
        }
    }
    void violation(std::uint64_t actor, const std::string& what)
    {
        note(actor, what);
        ++violation_count_;
        if (violations_.size() < 20) {
            violations_.push_back(line_start(actor) + " " + what);
        }
    }

    [[nodiscard]] std::uint64_t hash() const { return hash_; }
    [[nodiscard]] std::uint64_t notes() const { return notes_; }
    [[nodiscard]] std::size_t violation_count() const { return violation_count_; }
    /// The first ones, a line each.
    [[nodiscard]] std::string violations() const
    {
        std::string text;
        for (const std::string& line : violations_) {
            text += line + "\n";
        }
        return text;
    }

private:
    /// FNV-1a over whole numbers.
    void add(std::uint64_t number) { hash_ = (hash_ ^ number) * 0x0000'0100'0000'01B3U; }
    [[nodiscard]] std::string line_start(std::uint64_t actor) const
    {
        const auto time = scheduler_->now().time_since_epoch();
        return std::to_string(std::chrono::duration<double>{time}.count()) + " s, client " +
               std::to_string(actor) + ":";
    }

    const Scheduler* scheduler_;
    bool prints_;
    std::uint64_t hash_{0xCBF2'9CE4'8422'2325U};
    std::uint64_t notes_{0};
    std::size_t violation_count_{0};
    std::vector<std::string> violations_;
};

} // namespace busbar::test
