#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include <busbar/controller/program_types.hpp>
#include <busbar/controller/publishing_limits.hpp>
#include <busbar/core/api.hpp>

namespace busbar {
class LogSink;
} // namespace busbar

/// What of a program is published to clients (seed 000, 6-2-2), decided without any server.
namespace busbar::controller {

namespace detail {
class TypeFactsTable;
struct VariableFacts;
} // namespace detail

/// A limit of all variables together.
enum class PublishingLimit : std::uint8_t { Variables, Values, DataTypes };

/// As logs have it: "MaxVariables", "MaxValues", "MaxDataTypes" (seed 000, 7-1-6, code 0100).
[[nodiscard]] BUSBAR_API std::string_view name(PublishingLimit limit);

using PublishingLimitSet = std::bitset<3>; // by PublishingLimit

/// Why a variable by itself is not published, in the order in which it is looked for: that of the
/// conditions of seed 000, 1-2-2. Other tables of the manual have other orders; in that of 7-1-6
/// no variable could have too many elements, since its size would be found before.
enum class UnpublishedReason : std::uint8_t {
    MatrixOfStructures,
    MatrixInStructure,
    NestedStructure,
    Union,
    FirstIndex,
    MaxArrayElements,
    MaxMembers,
    MaxSize,
};

/// As logs have it, spelled as the manual spells it: "MultiDimensionalArray" for the first two,
/// "NestedStructre", "Union", "SubscriptOfArray", "MaxArrayElements", "MaxMembers", "MaxSize"
/// (seed 000, 7-1-6, code 0101).
[[nodiscard]] BUSBAR_API std::string_view name(UnpublishedReason reason);
/// The bit of the attached information of event 35D40000 (seed 000, 9-2-2).
[[nodiscard]] BUSBAR_API std::uint16_t event_bit(UnpublishedReason reason);

struct PublishedVariable {
    const GlobalVariable* variable{nullptr};
    /// Whose variable it is.
    const ProgramTypes* program{nullptr};
    /// Bytes, as ProgramTypes::size_of counts them.
    std::uint64_t size{0};
    /// One of a single value, one for each element of an array, and in structures all that are not
    /// structures themselves (6-2-2, *1). A union has as many as the member that has most.
    std::uint64_t values{0};
    /// Of the structure that it is of, not of those within; 0 if it is no structure.
    std::uint64_t members{0};
};

struct UnpublishedVariable {
    const GlobalVariable* variable{nullptr};
    UnpublishedReason reason{};
    std::uint64_t size{0};
    /// How many were published before this one was looked at.
    std::size_t position{0};
};

/// What became of variables that were looked at together. Numbers are positions in the lists of the
/// Publication, whose ends the group was added to.
struct PublicationGroup {
    std::size_t first_published{0};
    std::size_t first_unpublished{0};
    /// The limit over all that kept variables of the group away.
    std::optional<PublishingLimit> exceeded{};
};

/// Which variables are published. Kept up to date while variables are added.
///
/// Variables are looked at in the order of their names: by UTF-16 code units, the letters A to Z
/// as capitals whatever they are. Each is first held against the limits over all, then against
/// those of one variable; what is published counts towards the former, nothing else.
///
/// The first variable with which a limit over all would be exceeded ends the publication: neither
/// it nor any later one is published, though a smaller one might have had room. So the manual has
/// it of variables that are added online; and what clients see is the front of the list then, which
/// whoever has to shorten the list can tell at a glance. That variable may be one that by itself
/// could not be published either. Of several limits that it would exceed the first is told, in the
/// order of PublishingLimit: a variable too many has a value too many as well.
///
/// Structure definitions are the structures and unions that the published variables are made of,
/// each once, also those that are only elements of an array in another (6-2-2, *2).
class BUSBAR_API Publication {
public:
    /// `program` must outlive it.
    explicit Publication(const ProgramTypes& program, PublishingLimits limits = {});

    /// Looks at those variables of `program` whose names, upper and lower case being the same, are
    /// new: only among themselves, and not at all if a limit over all is reached or exceeded; the
    /// first such limit then counts as exceeded. For variables that were added while the server
    /// runs; what was decided before stays. `program`, which must outlive it, may have all
    /// variables or the new ones only; types of the same name must be what they were.
    PublicationGroup add(const ProgramTypes& program);

    /// What was decided of these variables, by their folded names, counts no more; what was kept
    /// away by a limit stays away, since only what is added is looked at (seed 000, 6-2-2). Gives
    /// the names of those that were published.
    std::vector<std::string> remove(const std::unordered_set<std::string>& names);

    /// In the order of looking; groups one behind another.
    [[nodiscard]] const std::vector<PublishedVariable>& published() const { return published_; }
    /// By a rule for single variables.
    [[nodiscard]] const std::vector<UnpublishedVariable>& unpublished() const
    {
        return unpublished_;
    }
    /// How many were kept away by a limit over all.
    [[nodiscard]] std::size_t left_out() const { return left_out_; }
    /// The limits over all that kept any away.
    [[nodiscard]] PublishingLimitSet exceeded() const { return exceeded_; }
    [[nodiscard]] bool exceeds(PublishingLimit limit) const
    {
        return exceeded_[static_cast<std::size_t>(limit)];
    }

    /// Of all that are published.
    [[nodiscard]] std::uint64_t values() const { return values_; }
    [[nodiscard]] std::uint64_t data_types() const { return data_types_.size(); }

    /// UnpublishedVariablesStatus (seed 000, 6-2-1): bits 0 to 2 for the limits over all, bit 3 if
    /// a variable by itself is not published.
    [[nodiscard]] std::uint16_t status_bits() const;
    /// The event_bits of those variables that are not published, from position `first` on.
    [[nodiscard]] std::uint16_t event_bits(std::size_t first = 0) const;

private:
    [[nodiscard]] std::optional<PublishingLimit> reached() const;
    void look_at(const GlobalVariable& variable, const ProgramTypes& program,
                 detail::TypeFactsTable& facts, PublicationGroup& group);
    [[nodiscard]] std::optional<PublishingLimit> exceeded_with(const detail::VariableFacts& facts,
                                                               std::size_t new_data_types) const;
    /// The totals of what is published.
    void count();

    PublishingLimits limits_;
    std::vector<PublishedVariable> published_;
    std::vector<UnpublishedVariable> unpublished_;
    std::size_t left_out_{0};
    PublishingLimitSet exceeded_;
    std::uint64_t values_{0};
    /// Folded names of the definitions that count, and of all variables that were looked at.
    std::unordered_set<std::string> data_types_;
    std::unordered_set<std::string> known_;
};

/// Tells what became of all variables, or of a group that was added: VariablePublished and
/// VariableNotPublished as they were looked at, then PublishingLimitExceeded, then
/// VariablesCounted with the totals (seed 000, 7-1-7).
BUSBAR_API void tell(LogSink& log, const Publication& publication);
BUSBAR_API void tell(LogSink& log, const Publication& publication, const PublicationGroup& group);

} // namespace busbar::controller
