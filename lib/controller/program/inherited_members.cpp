#include "inherited_members.hpp"

#include <iterator>
#include <utility>

#include <busbar/controller/program_types.hpp>

#include "program_problem.hpp"

namespace busbar::controller::detail {

InheritedMembers::InheritedMembers(std::vector<DerivedType>& types,
                                   const std::vector<Extension>& extensions, MemoryBudget& memory)
    : types_{&types}, extensions_{&extensions}, memory_{&memory}, states_(extensions.size())
{
    for (std::size_t i = 0; i < types.size() && !extensions.empty(); ++i) {
        by_name_.emplace(fold_name(types[i].name), i);
    }
    for (std::size_t i = 0; i < extensions.size(); ++i) {
        by_type_.emplace(extensions[i].type, i);
    }
}

std::vector<NotExtended> InheritedMembers::run()
{
    for (std::size_t i = 0; i < extensions_->size() && !is_exhausted_; ++i) {
        walk(i);
    }
    if (!failed_.empty()) {
        remove_failed();
    }
    return std::move(failed_);
}

void InheritedMembers::remove_failed()
{
    std::vector<DerivedType> stay;
    for (std::size_t i = 0; i < types_->size(); ++i) {
        const auto extension = by_type_.find(i);
        if (extension == by_type_.end() || states_[extension->second] != State::Failed) {
            stay.push_back(std::move((*types_)[i]));
        }
    }
    *types_ = std::move(stay);
}

void InheritedMembers::walk(std::size_t extension)
{
    std::vector<std::size_t> walked;
    for (std::size_t at = extension; states_[at] != State::Done;) {
        const Extension& now = (*extensions_)[at];
        if (states_[at] == State::Walked) {
            return fail_all(walked, "extends itself");
        }
        if (states_[at] == State::Failed) {
            return fail_all(walked, {});
        }
        states_[at] = State::Walked;
        walked.push_back(at);
        if (std::string refusal = refusal_of(now); !refusal.empty()) {
            return fail_all(walked, std::move(refusal));
        }
        const auto next = by_type_.find(by_name_.at(fold_name(now.base)));
        if (next == by_type_.end()) {
            break;
        }
        at = next->second;
    }
    for (auto each = walked.rbegin(); each != walked.rend() && !is_exhausted_; ++each) {
        inherit((*extensions_)[*each]);
        states_[*each] = State::Done;
    }
}

std::string InheritedMembers::refusal_of(const Extension& extension) const
{
    const auto base = by_name_.find(fold_name(extension.base));
    if (base == by_name_.end()) {
        return "extends " + quoted_name(extension.base) + ", which is not declared or left out";
    }
    if ((*types_)[base->second].kind != DerivedType::Kind::Structure) {
        return "extends " + quoted_name(extension.base) + ", which is not a structure";
    }
    return {};
}

void InheritedMembers::inherit(const Extension& extension)
{
    const DerivedType& base = (*types_)[by_name_.at(fold_name(extension.base))];
    std::vector<Member> members;
    for (const Member& each : base.members) {
        if (!memory_->take(sizeof each + each.name.size() + memory_of(each.type) +
                           memory_of(each.initial))) {
            is_exhausted_ = true;
            return;
        }
        members.push_back(each);
    }
    std::vector<Member>& own = (*types_)[extension.type].members;
    members.insert(members.end(), std::make_move_iterator(own.begin()),
                   std::make_move_iterator(own.end()));
    own = std::move(members);
}

void InheritedMembers::fail_all(std::vector<std::size_t>& walked, std::string reason)
{
    for (auto each = walked.rbegin(); each != walked.rend(); ++each) {
        const Extension& extension = (*extensions_)[*each];
        if (reason.empty()) {
            reason = "extends " + quoted_name(extension.base) + ", which is left out";
        }
        states_[*each] = State::Failed;
        failed_.push_back(
            {(*types_)[extension.type].name, extension.place, std::exchange(reason, {})});
    }
}

} // namespace busbar::controller::detail
