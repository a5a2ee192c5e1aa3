#include <algorithm>

#include <busbar/controller/program_types.hpp>

#include "constant_table.hpp"
#include "declaration_keywords.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 40U;
constexpr std::uint64_t size_of_enumeration = 2;

struct MemoryLayout {
    std::uint64_t size{0};
    std::uint64_t alignment{1};
};

MemoryLayout memory_layout_of(ElementaryType type, std::uint32_t length)
{
    switch (type) {
    case ElementaryType::Bool:
        return {1, 1};
    case ElementaryType::Time:
    case ElementaryType::Date:
    case ElementaryType::TimeOfDay:
    case ElementaryType::DateAndTime:
        return {4, 4};
    case ElementaryType::String:
        return {std::uint64_t{length} + 1, 1};
    case ElementaryType::Wstring:
        return {2 * (std::uint64_t{length} + 1), 2};
    default:
        return {size_of(type), size_of(type)};
    }
}

std::uint64_t rounded_to(std::uint64_t size, std::uint64_t multiple)
{
    return (size + multiple - 1) / multiple * multiple;
}

/// Measures types that are not checked yet.
class TypeMeter {
public:
    TypeMeter(const Program& program, const std::unordered_set<std::string>& unsettled)
        : program_{&program}, states_(program.types.size()), layouts_(program.types.size())
    {
        for (std::size_t i = 0; i < program.types.size(); ++i) {
            const std::string folded = fold_name(program.types[i].name);
            by_name_.emplace(folded, i);
            states_[i] = unsettled.contains(folded) ? State::Unknown : State::New;
        }
    }

    [[nodiscard]] std::unordered_map<std::string, std::uint64_t> sizes()
    {
        std::unordered_map<std::string, std::uint64_t> all;
        for (const auto& [name, index] : by_name_) {
            if (measure(index, 0)) {
                all.emplace(name, layouts_[index].size);
            }
        }
        return all;
    }

private:
    enum class State : std::uint8_t { New, Known, Unknown };

    bool measure(std::size_t index, std::size_t depth)
    {
        constexpr std::size_t most_depth = 64;
        if (states_[index] != State::New) {
            return states_[index] == State::Known;
        }
        if (depth >= most_depth) {
            return false;
        }
        // A type that contains itself has no size.
        states_[index] = State::Unknown;
        if (measure_type(program_->types[index], layouts_[index], depth)) {
            states_[index] = State::Known;
        }
        return states_[index] == State::Known;
    }
    bool measure_type(const DerivedType& type, MemoryLayout& all, std::size_t depth)
    {
        if (type.kind == DerivedType::Kind::Alias) {
            return measure_use(type.alias, all, depth);
        }
        if (type.kind == DerivedType::Kind::Enumeration) {
            all = {size_of_enumeration, size_of_enumeration};
            return true;
        }
        all = {};
        for (const Member& member : type.members) {
            MemoryLayout one;
            if (!measure_use(member.type, one, depth)) {
                return false;
            }
            const bool is_union = type.kind == DerivedType::Kind::Union;
            const std::uint64_t place = is_union ? 0 : rounded_to(all.size, one.alignment);
            all.size = std::min(most_bytes, std::max(all.size, place + one.size));
            all.alignment = std::max(all.alignment, one.alignment);
        }
        all.size = rounded_to(all.size, all.alignment);
        return true;
    }
    bool measure_use(const TypeUse& use, MemoryLayout& layout, std::size_t depth)
    {
        if (use.type_name.empty()) {
            layout = memory_layout_of(use.elementary, use.string_length);
        } else {
            const auto found = by_name_.find(fold_name(use.type_name));
            if (found == by_name_.end() || !measure(found->second, depth + 1)) {
                return false;
            }
            layout = layouts_[found->second];
        }
        for (const Bounds& bounds : use.dimensions) {
            const std::uint64_t count = static_cast<std::uint64_t>(bounds.upper) -
                                        static_cast<std::uint64_t>(bounds.lower) + 1;
            layout.size =
                count == 0 || layout.size > most_bytes / count ? most_bytes : layout.size * count;
        }
        return true;
    }

    const Program* program_;
    std::unordered_map<std::string, std::size_t> by_name_{};
    std::vector<State> states_;
    std::vector<MemoryLayout> layouts_;
};

} // namespace

std::optional<std::uint64_t> memory_size_of(std::string_view elementary)
{
    constexpr std::uint32_t usual_length = 80;
    const auto type = elementary_type(elementary);
    return type ? std::optional{memory_layout_of(*type, usual_length).size} : std::nullopt;
}

std::unordered_map<std::string, std::uint64_t>
memory_sizes(const Program& program, const std::unordered_set<std::string>& unsettled)
{
    return TypeMeter{program, unsettled}.sizes();
}

} // namespace busbar::controller::detail
