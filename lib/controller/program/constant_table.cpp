#include "constant_table.hpp"

#include <busbar/controller/program_types.hpp>
#include <busbar/core/text.hpp>

#include "declaration_keywords.hpp"
#include "program_checker.hpp"

namespace busbar::controller::detail {

namespace {

std::string qualified(std::string_view qualifier, std::string_view name)
{
    return fold_name(qualifier) + "." + fold_name(name);
}

std::string words_of(std::string_view name)
{
    constexpr std::size_t enough = 60;
    return printable(name, enough);
}

} // namespace

void ConstantTable::add_constant(const Declared& declared, const TypeUse& type)
{
    if (is_complete_ || declared.text.empty() || !type.dimensions.empty()) {
        return;
    }
    Entry entry;
    entry.name = declared.name;
    entry.text = declared.text;
    entry.file = file_;
    entry.place = declared.place;
    if (type.type_name.empty()) {
        entry.type = type.elementary;
    } else {
        // The values of its enumeration need no qualifier.
        entry.enumeration = fold_name(type.type_name);
    }
    const std::string folded = fold_name(declared.name);
    if (!list_.empty()) {
        by_qualified_.emplace(qualified(list_, declared.name), entries_.size());
    }
    add_name(entry, folded, entries_.size());
    entries_.push_back(std::move(entry));
}

void ConstantTable::begin_enumeration(std::string_view name)
{
    context_ = fold_name(name);
    last_explicit_ = none;
    distance_ = 0;
    if (!is_complete_) {
        enumerations_.insert(context_);
    }
}

void ConstantTable::add_enumerator(const Declared& declared)
{
    if (is_complete_) {
        return;
    }
    Entry entry;
    entry.name = declared.name;
    entry.text = declared.text;
    entry.file = file_;
    entry.place = declared.place;
    entry.enumeration = context_;
    entry.is_enumerator = true;
    if (!declared.text.empty()) {
        last_explicit_ = entries_.size();
        distance_ = 0;
    } else {
        entry.base = last_explicit_;
        // Without any before it, the first one is 0.
        entry.distance = last_explicit_ == none ? distance_ : distance_ + 1;
        ++distance_;
    }
    by_qualified_.emplace(qualified(context_, declared.name), entries_.size());
    add_name(entry, fold_name(declared.name), entries_.size());
    entries_.push_back(std::move(entry));
}

void ConstantTable::add_name(const Entry& entry, const std::string& folded, std::size_t index)
{
    const auto [found, is_new] = by_name_.emplace(folded, index);
    if (is_new) {
        return;
    }
    const bool is_constant = found->second != ambiguous && !entries_[found->second].is_enumerator;
    if (entry.is_enumerator && !is_constant) {
        const bool is_same =
            found->second != ambiguous && entries_[found->second].enumeration == entry.enumeration;
        found->second = is_same ? found->second : ambiguous;
    } else if (!entry.is_enumerator && !is_constant) {
        // A constant comes before values of enumerations, also for what is already read.
        found->second = index;
        needs_pass_ = true;
    }
}

std::size_t ConstantTable::at(const std::unordered_map<std::string, std::size_t>& map,
                              const std::string& key) const
{
    const auto found = map.find(key);
    return found == map.end() ? none : found->second;
}

std::size_t ConstantTable::index_of(const std::vector<std::string_view>& parts) const
{
    const std::string_view name = parts.back();
    if (parts.size() == 1) {
        const std::string own = context_.empty() ? std::string{} : qualified(context_, name);
        const std::size_t index = own.empty() ? none : at(by_qualified_, own);
        return index != none ? index : at(by_name_, fold_name(name));
    }
    const std::string_view qualifier = parts[parts.size() - 2];
    const std::size_t index = at(by_qualified_, qualified(qualifier, name));
    if (index != none || enumerations_.contains(fold_name(qualifier))) {
        return index;
    }
    // A text does not say the name of its list of variables.
    const std::size_t constant = at(by_name_, fold_name(name));
    const bool is_constant =
        constant != none && constant != ambiguous && !entries_[constant].is_enumerator;
    return is_constant ? constant : none;
}

bool ConstantTable::find(DeclarationCursor& cursor, const std::vector<std::string_view>& parts,
                         std::size_t offset, ExpressionValue& value)
{
    const std::size_t index = index_of(parts);
    if (index == none || index == ambiguous) {
        const bool is_later = index == none && !is_complete_;
        value.state = is_later        ? ExpressionValue::State::Later
                      : index == none ? ExpressionValue::State::Missing
                                      : ExpressionValue::State::Ambiguous;
        needs_pass_ = needs_pass_ || is_later;
        later_count_ += is_later ? 1 : 0;
        return true;
    }
    if (entries_[index].state == State::Unread) {
        compute(cursor, index);
    }
    const Entry& entry = entries_[index];
    if (entry.state == State::Reading || entry.state == State::Wrong) {
        const std::string words =
            entry.state == State::Reading ? place_words(index) + cycle_words(index) : entry.problem;
        return cursor.fail_with(offset, "found " + words_of(parts.back()) +
                                            ", which has no value: " + words);
    }
    if (entry.state == State::Later) {
        value.state = ExpressionValue::State::Later;
        ++later_count_;
        return true;
    }
    value.value = entry.value.value;
    value.notation = entry.value.notation;
    value.type = entry.value.type;
    value.state = entry.value.state;
    if (!entry.is_enumerator) {
        value.enumeration = entry.value.enumeration;
        value.name = entry.value.name;
    }
    return true;
}

void ConstantTable::compute(DeclarationCursor& by, std::size_t index)
{
    if (!enter()) {
        fail(index,
             "depends on more than " + std::to_string(limits_.max_depth) +
                 " others, one after another",
             place_words(index));
        return;
    }
    entries_[index].state = State::Reading;
    reading_.push_back(index);
    std::string context = entries_[index].enumeration;
    context_.swap(context);
    if (entries_[index].text.empty()) {
        compute_distance(by, index);
    } else {
        compute_text(by, index);
    }
    context_.swap(context);
    reading_.pop_back();
    leave();
}

void ConstantTable::compute_text(DeclarationCursor& by, std::size_t index)
{
    DeclarationCursor cursor{entries_[index].text, {}, nullptr, by.limits(), by.memory(), *this};
    ExpressionValue value;
    if (!read_expression(cursor, value) || !require_value(cursor, value) ||
        !(cursor.is_end() || cursor.fail("the end of the expression"))) {
        // What is found deeper comes with its place.
        constexpr std::string_view deeper = ", which has no value: ";
        const std::string& text = cursor.problem().text;
        const std::size_t root = text.find(deeper);
        fail(index, root == std::string::npos ? text : text.substr(root + deeper.size()),
             root == std::string::npos ? place_words(index) : std::string{});
        return;
    }
    settle(index, std::move(value));
}

void ConstantTable::compute_distance(DeclarationCursor& by, std::size_t index)
{
    Entry& entry = entries_[index];
    ExpressionValue value;
    std::optional<Whole> base = Whole{};
    if (entry.base != none) {
        const std::size_t from = entry.base;
        if (entries_[from].state == State::Unread) {
            compute(by, from);
        }
        if (entries_[from].state == State::Reading || entries_[from].state == State::Wrong) {
            fail(index,
                 entries_[from].state == State::Reading ? cycle_words(from)
                                                        : entries_[from].problem,
                 entries_[from].state == State::Reading ? place_words(from) : std::string{});
            return;
        }
        value.state = entries_[from].state == State::Later ? ExpressionValue::State::Later
                                                           : ExpressionValue::State::Known;
        base = whole_of(entries_[from].value.value);
    }
    const auto sum =
        base ? add(*base, {false, static_cast<std::uint64_t>(entry.distance)}) : std::nullopt;
    value.value = sum ? variant_of(*sum) : Variant{};
    settle(index, std::move(value));
}

void ConstantTable::settle(std::size_t index, ExpressionValue value)
{
    Entry& entry = entries_[index];
    if (value.is_later()) {
        entry.state = State::Later;
        return;
    }
    if (entry.is_enumerator) {
        if (!whole_of(value.value)) {
            fail(index, "has another value than a whole number", place_words(index));
            return;
        }
        value.name.clear();
        value.enumeration.clear();
        value.type.reset();
    } else if (entry.type && *entry.type <= ElementaryType::Lreal &&
               value.notation == InitialValue::Notation::Number) {
        auto converted = convert_value(value, *entry.type);
        const bool is_truncated =
            value.value.get_if<double>() != nullptr && *entry.type < ElementaryType::Real;
        if (!converted || is_truncated) {
            fail(index, converted ? "has a value with digits after the point" : converted.error(),
                 place_words(index));
            return;
        }
        value = std::move(*converted);
    }
    entry.value = std::move(value);
    entry.state = State::Known;
}

void ConstantTable::fail(std::size_t index, std::string problem, const std::string& where)
{
    entries_[index].problem = where + std::move(problem);
    entries_[index].state = State::Wrong;
}

std::string ConstantTable::cycle_words(std::size_t index) const
{
    constexpr std::size_t most = 8;
    std::string words = "depends on itself: ";
    std::size_t first = reading_.size();
    while (first > 0 && reading_[first - 1] != index) {
        --first;
    }
    std::size_t count = 0;
    for (std::size_t i = first == 0 ? 0 : first - 1; i < reading_.size(); ++i) {
        if (++count > most) {
            words += "... -> ";
            break;
        }
        words += words_of(entries_[reading_[i]].name) + " -> ";
    }
    return words + words_of(entries_[index].name);
}

std::string ConstantTable::place_words(std::size_t index) const
{
    return place_text(entries_[index].file, entries_[index].place) + ": ";
}

ExpressionValue::State ConstantTable::size_of(std::string_view type, std::uint64_t& size)
{
    if (const auto known = elementary_type(type)) {
        constexpr std::uint32_t usual_length = 80;
        const ResolvedType one{.elementary = *known, .string_length = usual_length};
        size = layout_of(one).in(ValueMemory::Source).size;
        return ExpressionValue::State::Known;
    }
    if (const auto found = sizes_.find(fold_name(type)); found != sizes_.end()) {
        size = found->second;
        return ExpressionValue::State::Known;
    }
    if (is_last_) {
        return ExpressionValue::State::Missing;
    }
    needs_pass_ = true;
    wants_sizes_ = true;
    ++later_count_;
    return ExpressionValue::State::Later;
}

bool ConstantTable::take_steps(std::size_t count)
{
    const bool is_enough = count <= steps_left_;
    steps_left_ -= is_enough ? count : steps_left_;
    return is_enough;
}

void ConstantTable::complete(const Program& program, bool is_last)
{
    if (wants_sizes_) {
        sizes_ = ProgramChecker::sizes(program, unsettled_);
    }
    is_complete_ = true;
    is_last_ = is_last || !wants_sizes_;
    needs_pass_ = false;
    unsettled_.clear();
    for (Entry& entry : entries_) {
        const bool is_final = entry.state == State::Known;
        entry.state = is_final ? entry.state : State::Unread;
    }
}

} // namespace busbar::controller::detail
