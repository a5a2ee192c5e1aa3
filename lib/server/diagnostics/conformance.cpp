#include <busbar/server/conformance.hpp>

#include <algorithm>
#include <span>

namespace busbar::server {

namespace detail::conformance_table {

namespace {

enum class WordKind : std::uint8_t { Absent, Declared, Flag, Number, Namespace0, Instance };

/// One word of the column `needs`. Its value is a member of the facts, or a number.
struct Word {
    bool ConformanceFacts::*flag{nullptr};
    std::size_t ConformanceFacts::*number{nullptr};
    std::uint32_t value{0};
    WordKind kind{WordKind::Absent};
};

constexpr Word absent()
{
    return {};
}

constexpr Word declared()
{
    return {.kind = WordKind::Declared};
}

constexpr Word flag(bool ConformanceFacts::*member)
{
    return {.flag = member, .kind = WordKind::Flag};
}

constexpr Word at_least(std::size_t ConformanceFacts::*member, std::uint32_t least)
{
    return {.number = member, .value = least, .kind = WordKind::Number};
}

constexpr Word at_least(Namespace0Size size)
{
    return {.value = static_cast<std::uint32_t>(size), .kind = WordKind::Namespace0};
}

constexpr Word instance_of(std::uint32_t type)
{
    return {.value = type, .kind = WordKind::Instance};
}

/// Words of which one must be true.
struct ClauseRow {
    std::string_view text;
    std::uint16_t first;
    std::uint16_t count;
};

/// All of its clauses must be true.
struct UnitRow {
    std::string_view name;
    std::uint16_t first;
    std::uint16_t count;
    bool has_test;
};

struct ProfileRow {
    std::string_view name;
    std::string_view uri;
    std::uint16_t first_include;
    std::uint16_t include_count;
    std::uint16_t first_unit;
    std::uint16_t unit_count;
};

#include <busbar/server/conformance_table.inc>

constexpr std::string_view no_test = "has no test";

bool is_true(const Word& word, const UnitRow& unit, const ConformanceFacts& facts)
{
    const auto& types = facts.instance_types;
    const auto& names = facts.declared_units;
    switch (word.kind) {
    case WordKind::Absent:
        return false;
    case WordKind::Declared:
        return std::find(names.begin(), names.end(), unit.name) != names.end();
    case WordKind::Flag:
        return facts.*word.flag;
    case WordKind::Number:
        return facts.*word.number >= word.value;
    case WordKind::Namespace0:
        return static_cast<std::uint32_t>(facts.namespace0) >= word.value;
    case WordKind::Instance:
        return std::binary_search(types.begin(), types.end(), word.value);
    }
    return false;
}

std::span<const std::uint16_t> clauses_of(const UnitRow& unit)
{
    return std::span{unit_clauses}.subspan(unit.first, unit.count);
}

bool is_met(const ClauseRow& clause, const UnitRow& unit, const ConformanceFacts& facts)
{
    const auto alternatives = std::span{words}.subspan(clause.first, clause.count);
    return std::any_of(alternatives.begin(), alternatives.end(),
                       [&](const Word& word) { return is_true(word, unit, facts); });
}

/// Returns what the unit lacks; empty if it lacks nothing.
std::string_view find_lack(const UnitRow& unit, const ConformanceFacts& facts)
{
    for (const std::uint16_t clause : clauses_of(unit)) {
        if (!is_met(clause_rows[clause], unit, facts)) {
            return clause_rows[clause].text;
        }
    }
    return unit.has_test ? std::string_view{} : no_test;
}

bool is_of_clients(const UnitRow& unit)
{
    const auto clauses = clauses_of(unit);
    return std::any_of(clauses.begin(), clauses.end(),
                       [](std::uint16_t clause) { return clause_rows[clause].text == "client"; });
}

/// Returns the profile and all that it includes, directly or not, each once.
std::vector<std::size_t> with_included(std::size_t profile)
{
    std::vector<std::size_t> all{profile};
    for (std::size_t i = 0; i < all.size(); ++i) {
        const ProfileRow& row = profile_rows[all[i]];
        for (const std::size_t included :
             std::span{profile_includes}.subspan(row.first_include, row.include_count)) {
            if (std::find(all.begin(), all.end(), included) == all.end()) {
                all.push_back(included);
            }
        }
    }
    return all;
}

/// `lacks` has the unmet need of each unit.
ProfileAssessment assess_profile(std::size_t profile, std::span<const std::string_view> lacks)
{
    ProfileAssessment result;
    result.name = profile_rows[profile].name;
    result.uri = profile_rows[profile].uri;
    result.is_client = result.uri.find("/Client/") != std::string_view::npos;
    std::vector<bool> is_seen(std::size(unit_rows));
    for (const std::size_t part : with_included(profile)) {
        const ProfileRow& row = profile_rows[part];
        for (const std::uint16_t unit :
             std::span{profile_units}.subspan(row.first_unit, row.unit_count)) {
            if (!lacks[unit].empty() && !is_seen[unit]) {
                result.lacks.push_back({unit_rows[unit].name, lacks[unit]});
            }
            is_seen[unit] = true;
        }
    }
    result.is_claimed = result.lacks.empty();
    return result;
}

} // namespace

} // namespace detail::conformance_table

const ProfileAssessment* Conformance::find(std::string_view name) const
{
    const auto found =
        std::find_if(profiles.begin(), profiles.end(),
                     [&](const ProfileAssessment& profile) { return profile.name == name; });
    return found != profiles.end() ? &*found : nullptr;
}

namespace {

/// `find_lack` returns what a unit lacks; empty for nothing.
template <typename FindLack>
Conformance assess_all(FindLack find_lack)
{
    using namespace detail::conformance_table;
    Conformance result;
    std::vector<std::string_view> lacks;
    for (const UnitRow& unit : unit_rows) {
        lacks.push_back(find_lack(unit));
        if (lacks.back().empty()) {
            (is_of_clients(unit) ? result.client_units : result.units).push_back(unit.name);
        }
    }
    for (std::size_t profile = 0; profile < std::size(profile_rows); ++profile) {
        result.profiles.push_back(assess_profile(profile, lacks));
    }
    return result;
}

} // namespace

Conformance assess(const ConformanceFacts& facts)
{
    using namespace detail::conformance_table;
    return assess_all([&](const UnitRow& unit) { return find_lack(unit, facts); });
}

Conformance assess_units(std::span<const std::string_view> units)
{
    using namespace detail::conformance_table;
    return assess_all([&](const UnitRow& unit) -> std::string_view {
        const bool is_named = std::find(units.begin(), units.end(), unit.name) != units.end();
        return is_named ? "" : "does not name";
    });
}

} // namespace busbar::server
