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

/// Decides which variables of a program are published to clients (W588, 6-2-2),
/// without a server.
namespace busbar::controller {

/// A limit of all variables together.
enum class PublishingLimit : std::uint8_t { Variables, Values, DataTypes };

/// Returns the name used in logs: "MaxVariables", "MaxValues", "MaxDataTypes"
/// (W588, 7-1-6, code 0100).
[[nodiscard]] BUSBAR_API std::string_view name(PublishingLimit limit);

using PublishingLimitSet = std::bitset<3>; // indexed by PublishingLimit

/// The reason why a variable by itself is not published, in the order of the checks: that of the
/// conditions in W588, 1-2-2. Other tables of the manual have other orders;
/// in that of 7-1-6 no variable could have too many elements, since its size would be found first.
enum class UnpublishedReason : std::uint8_t {
    MatrixOfStructures,
    MatrixInStructure,
    NestedStructure,
    Union,
    FirstIndex,
    MaxArrayElements,
    MaxMembers,
    MaxSize,
    /// It was left out of the program, for example as an instance of a function block. The manual's
    /// tool does not let such variables be published.
    Unserved,
};

/// Returns the name used in logs, with the manual's spelling: "MultiDimensionalArray" for the first
/// two, "NestedStructre", "Union", "SubscriptOfArray", "MaxArrayElements", "MaxMembers", "MaxSize"
/// (W588, 7-1-6, code 0101), and "Unserved", which the manual does not have.
[[nodiscard]] BUSBAR_API std::string_view name(UnpublishedReason reason);
/// Returns the bit of the attached information of event 35D40000 (W588, 9-2-2); for Unserved bit 8,
/// which the manual does not use.
[[nodiscard]] BUSBAR_API std::uint16_t event_bit(UnpublishedReason reason);

/// A variable that clients see.
struct PublishedVariable {
    const GlobalVariable* variable{nullptr};
    /// The program that the variable belongs to.
    const ProgramTypes* program{nullptr};
    /// In bytes, as in ProgramTypes::size_of.
    std::uint64_t size{0};
    /// One for a single value, one for each element of an array, and for structures all members
    /// that are not structures themselves (6-2-2, *1). A union has as many as the member that has
    /// most.
    std::uint64_t values{0};
    /// The members of its structure, without those of nested ones; 0 if it is not a structure.
    std::uint64_t members{0};
};

/// A variable that was to be published and is not.
struct UnpublishedVariable {
    const GlobalVariable* variable{nullptr};
    UnpublishedReason reason{};
    /// 0 for Unserved.
    std::uint64_t size{0};
    /// The number of variables published before this one was checked.
    std::size_t position{0};
    /// For Unserved: what says why. `variable` is its part.
    const LeftOut* left_out{nullptr};
};

/// Says why: "is too large (4096 bytes)", or for Unserved the problem with its place.
[[nodiscard]] BUSBAR_API std::string reason_text(const UnpublishedVariable& variable);

/// The result for variables that were checked together. Numbers are positions in the lists of the
/// Publication, to whose ends the group was appended.
struct PublicationGroup {
    std::size_t first_published{0};
    std::size_t first_unpublished{0};
    /// The limit over all that excluded variables of the group.
    std::optional<PublishingLimit> exceeded{};
};

/// The decision which variables are published. Kept up to date while variables are added.
///
/// Variables are checked in the order of their names: by UTF-16 code units, with the letters A to Z
/// as capitals. Each is compared first with the limits over all, then with those of one variable;
/// only published variables count towards the former.
///
/// The first variable that would exceed a limit over all ends the publication: neither it nor any
/// later one is published, even if a smaller one would fit. The manual requires that for variables
/// that are added online; and clients then see the beginning of the list, which is clear to a
/// person who has to shorten the list. That variable may be one that could not be published by
/// itself either. If it would exceed several limits the first in the order of PublishingLimit is
/// reported: a variable too many is also a value too many.
///
/// Structure definitions are the structures and unions that the published variables consist of,
/// each once, including those that are only elements of an array in another (6-2-2, *2).
class BUSBAR_API Publication {
public:
    /// `program` must outlive it.
    explicit Publication(const ProgramTypes& program, PublishingLimits limits = {});

    /// Checks those variables of `program` whose names, ignoring case, are new: only among
    /// themselves, and not at all if a limit over all is reached or exceeded; the first such limit
    /// then counts as exceeded. For variables that are added while the server runs; earlier
    /// decisions stay. `program`, which must outlive it, may have all variables or only the new
    /// ones; types with the same name must be unchanged.
    PublicationGroup add(const ProgramTypes& program);

    /// Discards the decisions about these variables, given by their folded names; variables
    /// excluded by a limit stay excluded, since only added ones are checked
    /// (W588, 6-2-2). Returns the names of those that were published.
    std::vector<std::string> remove(const std::unordered_set<std::string>& names);

    /// In the order of the checks; one group after another.
    [[nodiscard]] const std::vector<PublishedVariable>& published() const { return published_; }
    /// The variables that a rule for single variables excludes.
    [[nodiscard]] const std::vector<UnpublishedVariable>& unpublished() const
    {
        return unpublished_;
    }
    /// The number of variables excluded by a limit over all.
    [[nodiscard]] std::size_t left_out() const { return left_out_; }
    /// The limits over all that excluded any.
    [[nodiscard]] PublishingLimitSet exceeded() const { return exceeded_; }
    /// True if this limit excluded a variable.
    [[nodiscard]] bool exceeds(PublishingLimit limit) const
    {
        return exceeded_[static_cast<std::size_t>(limit)];
    }

    /// The values of all published variables.
    [[nodiscard]] std::uint64_t values() const { return values_; }
    [[nodiscard]] std::uint64_t data_types() const { return data_types_.size(); }

    /// UnpublishedVariablesStatus (W588, 6-2-1): bits 0 to 2 for the limits
    /// over all, bit 3 if a variable by itself is not published.
    [[nodiscard]] std::uint16_t status_bits() const;
    /// The event_bits of the variables that are not published, from position `first` on.
    [[nodiscard]] std::uint16_t event_bits(std::size_t first = 0) const;

private:
    [[nodiscard]] std::optional<PublishingLimit> reached() const;
    void look_at(const GlobalVariable& variable, const ProgramTypes& program,
                 PublicationGroup& group);
    [[nodiscard]] std::optional<PublishingLimit> exceeded_with(std::uint64_t values,
                                                               std::size_t new_data_types) const;
    /// Computes the totals of the published variables.
    void count();

    PublishingLimits limits_;
    std::vector<PublishedVariable> published_;
    std::vector<UnpublishedVariable> unpublished_;
    std::size_t left_out_{0};
    PublishingLimitSet exceeded_;
    std::uint64_t values_{0};
    /// Folded names of the counted definitions, and of all checked variables.
    std::unordered_set<std::string> data_types_;
    std::unordered_set<std::string> known_;
};

/// Records the result for all variables, or for a group that was added: VariablePublished and
/// VariableNotPublished in the order of the checks, then PublishingLimitExceeded, then
/// VariablesCounted with the totals (W588, 7-1-7).
BUSBAR_API void tell(LogSink& log, const Publication& publication);
BUSBAR_API void tell(LogSink& log, const Publication& publication, const PublicationGroup& group);

} // namespace busbar::controller
