#include "type_facts.hpp"

#include <algorithm>

namespace busbar::controller::detail {

namespace {

/// Greater than any limit, and far from overflow.
constexpr std::uint64_t most_values = std::uint64_t{1} << 56U;

std::uint64_t times(std::uint64_t a, std::uint64_t b)
{
    return b != 0 && a > most_values / b ? most_values : a * b;
}

bool is_structured(const ResolvedType& type)
{
    return type.kind == ResolvedType::Kind::Structure || type.kind == ResolvedType::Kind::Union;
}

bool begins_elsewhere(const std::vector<Bounds>& dimensions)
{
    return std::any_of(dimensions.begin(), dimensions.end(),
                       [](const Bounds& bounds) { return bounds.lower != 0; });
}

} // namespace

VariableFacts TypeFactsTable::of(const TypeUse& use)
{
    const ResolvedType type = program_->resolve(use);
    VariableFacts facts;
    facts.size = program_->size_of(use);
    facts.elements = type.elements();
    facts.values = facts.elements;
    facts.has_first_index = begins_elsewhere(type.dimensions);
    if (!is_structured(type)) {
        return facts;
    }
    const TypeFacts& inner = of_type(*type.type);
    facts.structure = type.type;
    facts.values = times(facts.elements, inner.values);
    facts.members = inner.members;
    facts.levels = inner.levels;
    facts.is_matrix_of_structures = type.dimensions.size() > 1;
    facts.has_matrix = inner.has_matrix;
    facts.has_union = inner.has_union;
    facts.has_first_index = facts.has_first_index || inner.has_first_index;
    return facts;
}

std::vector<std::string>
TypeFactsTable::new_definitions(const DerivedType* top,
                                const std::unordered_set<std::string>& known, std::uint64_t room)
{
    std::vector<std::string> found;
    std::unordered_set<const DerivedType*> seen;
    std::vector<const DerivedType*> open;
    const auto visit = [&](const DerivedType* type) {
        if (found.size() <= room && seen.insert(type).second) {
            std::string name = fold_name(type->name);
            // If a type is known, so are the types that it consists of.
            if (!known.contains(name)) {
                found.push_back(std::move(name));
                open.push_back(type);
            }
        }
    };
    if (top != nullptr) {
        visit(top);
    }
    while (!open.empty() && found.size() <= room) {
        const DerivedType* const type = open.back();
        open.pop_back();
        for (const DerivedType* inner : of_type(*type).inner) {
            visit(inner);
        }
    }
    return found;
}

const TypeFacts& TypeFactsTable::of_type(const DerivedType& type)
{
    auto& kept = facts_[static_cast<std::size_t>(&type - program_->program().types.data())];
    if (!kept) {
        kept = find_facts(type);
    }
    return *kept;
}

// Recursion is limited by ProgramLimits::max_depth.
TypeFacts TypeFactsTable::find_facts(const DerivedType& type)
{
    TypeFacts facts;
    facts.members = type.members.size();
    facts.has_union = type.kind == DerivedType::Kind::Union;
    for (const Member& member : type.members) {
        add_member(facts, type, member.type);
    }
    ++facts.levels;
    std::sort(facts.inner.begin(), facts.inner.end());
    facts.inner.erase(std::unique(facts.inner.begin(), facts.inner.end()), facts.inner.end());
    return facts;
}

void TypeFactsTable::add_member(TypeFacts& facts, const DerivedType& type, const TypeUse& use)
{
    const ResolvedType member = program_->resolve(use);
    std::uint64_t values = member.elements();
    facts.has_matrix = facts.has_matrix || member.dimensions.size() > 1;
    facts.has_first_index = facts.has_first_index || begins_elsewhere(member.dimensions);
    if (is_structured(member)) {
        const TypeFacts& inner = of_type(*member.type);
        values = times(values, inner.values);
        facts.levels = std::max(facts.levels, inner.levels);
        facts.has_matrix = facts.has_matrix || inner.has_matrix;
        facts.has_union = facts.has_union || inner.has_union;
        facts.has_first_index = facts.has_first_index || inner.has_first_index;
        facts.inner.push_back(member.type);
    }
    facts.values = type.kind == DerivedType::Kind::Union
                       ? std::max(facts.values, values)
                       : std::min(most_values, facts.values + values);
}

} // namespace busbar::controller::detail
