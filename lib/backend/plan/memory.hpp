#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include <busbar/backend/plan.hpp>

namespace busbar::backend::detail {

/// Remembers what a peer refuses: addresses, and gaps between ranges that cannot be read across.
class PlanMemory {
public:
    struct Refusal {
        StatusCode status;
        TimePoint until;
        std::uint16_t code{0};
    };

    explicit PlanMemory(std::size_t limit) : limit_{limit} {}

    /// Null if the address is not known to be refused. It is still known when `until` is over.
    [[nodiscard]] const Refusal* refusal_of(const PlanAddress& address) const;
    /// True if an address that begins in [begin, end) is known to be refused.
    [[nodiscard]] bool is_refused_within(std::uint32_t area, std::uint64_t begin,
                                         std::uint64_t end) const;
    void refused(const PlanAddress& address, const Refusal& refusal, TimePoint now);
    void accepted(const PlanAddress& address);

    /// True if a request must not reach beyond the begin of `address`.
    [[nodiscard]] bool is_cut(const PlanAddress& address, TimePoint now) const;
    void cut(const PlanAddress& address, TimePoint until, TimePoint now);

    void forget();

private:
    std::size_t limit_;
    std::map<PlanAddress, Refusal> refusals_;
    /// Keyed by area and offset.
    std::map<std::pair<std::uint32_t, std::uint32_t>, TimePoint> cuts_;
};

} // namespace busbar::backend::detail
