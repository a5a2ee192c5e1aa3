#include <busbar/controller/publishing.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <busbar/controller/publishing_limits.hpp>

#include "core/utf8.hpp"

namespace busbar::controller {

namespace {

/// Decodes a valid UTF-8 sequence.
char32_t code_point(std::string_view sequence)
{
    const auto lead = static_cast<unsigned char>(sequence[0]);
    if (sequence.size() == 1) {
        return lead;
    }
    // A lead byte begins with as many ones as the sequence has bytes, followed by a zero.
    char32_t value = lead & (0x7FU >> sequence.size());
    for (const char c : sequence.substr(1)) {
        value = (value << 6U) | (static_cast<unsigned char>(c) & 0x3FU);
    }
    return value;
}

void append_code_units(std::u16string& key, char32_t character)
{
    constexpr char32_t first_supplementary = 0x10000;
    if (character < first_supplementary) {
        const bool is_small = character >= U'a' && character <= U'z';
        key += static_cast<char16_t>(is_small ? character - U'a' + U'A' : character);
        return;
    }
    const char32_t rest = character - first_supplementary;
    key += static_cast<char16_t>(0xD800U + (rest >> 10U));
    key += static_cast<char16_t>(0xDC00U + (rest & 0x3FFU));
}

/// Returns the key that names are sorted by: UTF-16 code units with small ASCII letters as capitals
/// (W588, 6-2-2, step 1). Characters beyond 16 bits become surrogates, which precede U+E000 to
/// U+FFFF. `name` must be UTF-8.
std::u16string sorting_key(std::string_view name)
{
    std::u16string key;
    key.reserve(name.size());
    while (!name.empty()) {
        const std::size_t size = busbar::detail::utf8_sequence(name);
        if (size == 0) { // the name was not checked
            break;
        }
        append_code_units(key, code_point(name.substr(0, size)));
        name.remove_prefix(size);
    }
    return key;
}

bool exceeds_limit(const std::optional<std::uint64_t>& limit, std::uint64_t count)
{
    return limit && count > *limit;
}

bool is_reached(const std::optional<std::uint64_t>& limit, std::uint64_t count)
{
    return limit && count >= *limit;
}

/// Returns the first rule for single variables that excludes the variable.
std::optional<UnpublishedReason> reason_against(const PublishingLimits& limits,
                                                const ProgramTypes& program,
                                                const ResolvedType& type)
{
    const ValueLayout all = program.layout(type);
    const bool is_structured = type.is_structured();
    const ValueLayout inner = is_structured ? program.layout(*type.type) : ValueLayout{};
    const std::size_t members = is_structured ? type.type->members.size() : 0;
    const std::pair<bool, UnpublishedReason> rules[] = {
        {is_structured && type.dimensions.size() > 1 && !limits.allows_matrices_with_structures,
         UnpublishedReason::MatrixOfStructures},
        {inner.has_matrix && !limits.allows_matrices_with_structures,
         UnpublishedReason::MatrixInStructure},
        {exceeds_limit(limits.max_levels, all.levels), UnpublishedReason::NestedStructure},
        {all.has_union && !limits.allows_unions, UnpublishedReason::Union},
        {all.has_first_index && !limits.allows_any_first_index, UnpublishedReason::FirstIndex},
        {exceeds_limit(limits.max_elements, type.elements()), UnpublishedReason::MaxArrayElements},
        {exceeds_limit(limits.max_members, members), UnpublishedReason::MaxMembers},
        {exceeds_limit(limits.max_size, all.in(ValueMemory::Cpu).size), UnpublishedReason::MaxSize},
    };
    for (const auto& [applies, reason] : rules) {
        if (applies) {
            return reason;
        }
    }
    return {};
}

/// Returns the folded names of the structures and unions that a value consists of and that are not
/// in `known`; stops once there are more than `room`.
std::vector<std::string> new_definitions(const ProgramTypes& program, const ResolvedType& value,
                                         const std::unordered_set<std::string>& known,
                                         std::uint64_t room)
{
    std::vector<std::string> found;
    std::unordered_set<const DerivedType*> seen;
    std::vector<const DerivedType*> open;
    const auto visit = [&](const ResolvedType& type) {
        if (type.is_structured() && found.size() <= room && seen.insert(type.type).second) {
            std::string name = fold_name(type.type->name);
            // If a type is known, so are the types that it consists of.
            if (!known.contains(name)) {
                found.push_back(std::move(name));
                open.push_back(type.type);
            }
        }
    };
    visit(value);
    while (!open.empty() && found.size() <= room) {
        const DerivedType& type = *open.back();
        open.pop_back();
        for (const ResolvedType& member : program.members(type)) {
            visit(member);
        }
    }
    return found;
}

struct NamedVariable {
    std::u16string key;
    const GlobalVariable* variable;
    /// Null if the program serves it.
    const LeftOut* left_out;
};

/// Lists the program's variables that are not in `known`, and adds their names to it.
std::vector<NamedVariable> new_variables(const Program& program,
                                         std::unordered_set<std::string>& known)
{
    std::vector<NamedVariable> group;
    const auto add = [&](const GlobalVariable& variable, const LeftOut* left_out) {
        if (variable.publish != NetworkPublish::Hidden &&
            known.insert(fold_name(variable.name)).second) {
            group.push_back({sorting_key(variable.name), &variable, left_out});
        }
    };
    for (const GlobalVariable& variable : program.variables) {
        add(variable, nullptr);
    }
    for (const LeftOut& each : program.left_out) {
        if (each.kind == LeftOut::Kind::Variable) {
            add(each.declared, &each);
        }
    }
    std::sort(group.begin(), group.end(),
              [](const NamedVariable& a, const NamedVariable& b) { return a.key < b.key; });
    return group;
}

} // namespace

Publication::Publication(const ProgramTypes& program, PublishingLimits limits) : limits_{limits}
{
    add(program);
}

PublicationGroup Publication::add(const ProgramTypes& program)
{
    PublicationGroup group{published_.size(), unpublished_.size(), {}};
    const std::vector<NamedVariable> added = new_variables(program.program(), known_);
    if (!added.empty()) {
        group.exceeded = reached();
    }
    std::size_t looked_at = 0;
    while (looked_at < added.size() && !group.exceeded) {
        const NamedVariable& next = added[looked_at];
        if (next.left_out != nullptr) {
            unpublished_.push_back(
                {next.variable, UnpublishedReason::Unserved, 0, published_.size(), next.left_out});
        } else {
            look_at(*next.variable, program, group);
        }
        looked_at += group.exceeded ? 0U : 1U;
    }
    left_out_ += added.size() - looked_at;
    if (group.exceeded) {
        exceeded_.set(static_cast<std::size_t>(*group.exceeded));
    }
    return group;
}

std::vector<std::string> Publication::remove(const std::unordered_set<std::string>& names)
{
    std::size_t gone = 0;
    for (const std::string& name : names) {
        gone += known_.erase(name);
    }
    if (gone == 0) {
        return {};
    }
    std::vector<std::string> removed;
    std::vector<std::size_t> positions{0}; // indexed by the old position
    std::vector<PublishedVariable> stay;
    for (const PublishedVariable& each : published_) {
        if (names.contains(fold_name(each.variable->name))) {
            removed.push_back(each.variable->name);
        } else {
            stay.push_back(each);
        }
        positions.push_back(stay.size());
    }
    published_ = std::move(stay);
    std::erase_if(unpublished_, [&](const UnpublishedVariable& each) {
        return names.contains(fold_name(each.variable->name));
    });
    for (UnpublishedVariable& each : unpublished_) {
        each.position = positions[each.position];
    }
    left_out_ = known_.size() - published_.size() - unpublished_.size();
    if (left_out_ == 0) {
        exceeded_.reset();
    }
    count();
    return removed;
}

void Publication::count()
{
    values_ = 0;
    data_types_.clear();
    for (const PublishedVariable& each : published_) {
        auto definitions = new_definitions(
            *each.program, each.program->resolve(each.variable->type), data_types_, UINT64_MAX);
        data_types_.insert(std::make_move_iterator(definitions.begin()),
                           std::make_move_iterator(definitions.end()));
        values_ += each.values;
    }
}

std::optional<PublishingLimit> Publication::reached() const
{
    const std::pair<PublishingLimit, bool> limits[] = {
        {PublishingLimit::Variables, is_reached(limits_.max_variables, published_.size())},
        {PublishingLimit::Values, is_reached(limits_.max_values, values_)},
        // A limit of 0 structures does not keep other variables out.
        {PublishingLimit::DataTypes,
         data_types() != 0 && is_reached(limits_.max_data_types, data_types())},
    };
    for (const auto& [limit, is_there] : limits) {
        if (is_there || exceeds(limit)) {
            return limit;
        }
    }
    return {};
}

void Publication::look_at(const GlobalVariable& variable, const ProgramTypes& program,
                          PublicationGroup& group)
{
    const ResolvedType type = program.resolve(variable.type);
    const ValueLayout layout = program.layout(type);
    const std::uint64_t size = layout.in(ValueMemory::Cpu).size;
    const std::uint64_t room =
        limits_.max_data_types ? *limits_.max_data_types - data_types() : UINT64_MAX;
    std::vector<std::string> definitions;
    if (limits_.max_data_types) {
        definitions = new_definitions(program, type, data_types_, room);
    }
    group.exceeded = exceeded_with(layout.values, definitions.size());
    if (group.exceeded) {
        return;
    }
    if (const auto reason = reason_against(limits_, program, type)) {
        unpublished_.push_back({&variable, *reason, size, published_.size()});
        return;
    }
    if (!limits_.max_data_types) {
        definitions = new_definitions(program, type, data_types_, room);
    }
    const std::size_t members = type.is_structured() ? type.type->members.size() : 0;
    published_.push_back({&variable, &program, size, layout.values, members});
    values_ += layout.values;
    data_types_.insert(definitions.begin(), definitions.end());
}

std::optional<PublishingLimit> Publication::exceeded_with(std::uint64_t values,
                                                          std::size_t new_data_types) const
{
    if (exceeds_limit(limits_.max_variables, published_.size() + 1)) {
        return PublishingLimit::Variables;
    }
    if (exceeds_limit(limits_.max_values, values_ + values)) {
        return PublishingLimit::Values;
    }
    if (exceeds_limit(limits_.max_data_types, data_types() + new_data_types)) {
        return PublishingLimit::DataTypes;
    }
    return {};
}

std::uint16_t Publication::status_bits() const
{
    constexpr unsigned unsupported = 0x8;
    return static_cast<std::uint16_t>(exceeded_.to_ulong() |
                                      (unpublished_.empty() ? 0U : unsupported));
}

std::uint16_t Publication::event_bits(std::size_t first) const
{
    unsigned bits = 0;
    for (std::size_t i = first; i < unpublished_.size(); ++i) {
        bits |= event_bit(unpublished_[i].reason);
    }
    return static_cast<std::uint16_t>(bits);
}

PublishingLimits nj501_publishing()
{
    PublishingLimits limits;
    limits.max_variables = 10'000;
    limits.max_values = 10'000;
    limits.max_data_types = 100;
    limits.max_size = 1'024;
    limits.max_elements = 1'024;
    limits.max_members = 100;
    limits.max_levels = 3;
    limits.allows_any_first_index = false;
    limits.allows_matrices_with_structures = false;
    limits.allows_unions = false;
    return limits;
}

PublishingLimits nx102_publishing()
{
    return nj501_publishing();
}

} // namespace busbar::controller
