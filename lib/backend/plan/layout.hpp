#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/backend/plan.hpp>

#include "backend/plan/memory.hpp"

namespace busbar::backend::detail {

/// An address of a batch, or a piece of one that is too wide for a request.
struct PlanPart {
    PlanAddress address;
    /// PlanShare::group of reads of its area.
    std::uint32_t group{0};
    /// The address that it belongs to, in the order of the batch.
    std::uint32_t index{0};
    /// The place of its words among those of the batch.
    std::size_t first_word{0};
    bool is_piece{false};
    /// Read by itself, since the peer refused it before.
    bool is_alone{false};
    /// PlanWrite::mask.
    std::uint16_t mask{0xFFFF};
};

/// Parts that one request has, which follow one another, and the ranges that hold them.
struct PlanJob {
    std::size_t begin{0};
    std::size_t end{0};
    std::vector<PlanAddress> ranges{};
    /// The division that it comes from, as an index of the batch; no_division if it was planned.
    std::size_t division{SIZE_MAX};
};

inline constexpr std::size_t no_division = SIZE_MAX;

/// The rules by area.
class PlanRules {
public:
    explicit PlanRules(std::vector<PlanRule> rules);
    /// Null if the area has none.
    [[nodiscard]] const PlanRule* find(std::uint32_t area) const;
    /// Replaces the rules of these areas.
    void change(std::span<const PlanRule> rules);
    /// Counts the changes that made another rule of one.
    [[nodiscard]] std::uint64_t version() const { return version_; }

private:
    std::vector<PlanRule> rules_;
    std::uint64_t version_{0};
};

/// True if a request can have it: it has a width and an end, and an area with a `rule`.
[[nodiscard]] bool is_possible(const PlanAddress& address, const PlanRule* rule);

/// Appends `whole`, in pieces of at most `max_width` units.
void append_pieces(std::vector<PlanPart>& parts, PlanPart whole, std::uint32_t max_width,
                   std::uint32_t words_per_unit);

/// Brings the parts of a read into the order in which lay_out() takes them.
void sort_parts(std::vector<PlanPart>& parts);

/// Returns the fewest reads for parts [begin, end) of `parts`, which are sorted.
[[nodiscard]] std::vector<PlanJob> lay_out(std::span<const PlanPart> parts, std::size_t begin,
                                           std::size_t end, const PlanRules& rules,
                                           const PlanMemory& memory, TimePoint now);

/// Returns writes for parts [begin, end) in their order; neighbours go together where they may.
[[nodiscard]] std::vector<PlanJob> lay_out_writes(std::span<const PlanPart> parts,
                                                  std::size_t begin, std::size_t end,
                                                  const PlanRules& rules);

/// Returns where a refused read or write of parts [begin, end) is divided; `end` if it has one
/// address only. Equal addresses stay together.
[[nodiscard]] std::size_t divide(std::span<const PlanPart> parts, std::size_t begin,
                                 std::size_t end);

} // namespace busbar::backend::detail
