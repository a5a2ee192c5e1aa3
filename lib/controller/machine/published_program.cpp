#include <busbar/controller/published_program.hpp>

#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <busbar/controller/machine_types.hpp>

#include "online_edit.hpp"

namespace busbar::controller {

namespace {

using Handles = std::unordered_map<std::string, std::uint32_t>;

/// Indices of the variables to add to an image: those of `published`, which must belong to the
/// program, followed by RETAIN variables, without those that the image already has.
std::vector<std::size_t> variables_of_image(const ProgramTypes& types,
                                            std::span<const PublishedVariable> published,
                                            const Handles& in_image)
{
    const std::vector<GlobalVariable>& all = types.program().variables;
    std::vector<std::size_t> indices;
    std::vector<bool> is_published(all.size());
    indices.reserve(published.size());
    for (const PublishedVariable& each : published) {
        const auto index = static_cast<std::size_t>(each.variable - all.data());
        is_published[index] = true;
        if (!in_image.contains(fold_name(each.variable->name))) {
            indices.push_back(index);
        }
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool is_kept = all[i].is_retained && !all[i].is_constant && !is_published[i];
        if (is_kept && !in_image.contains(fold_name(all[i].name)) &&
            !types.layout(types.resolve(all[i].type)).has_union) {
            indices.push_back(i);
        }
    }
    return indices;
}

/// Folded names of the variables of `before` that clients could see and that `edited` no longer
/// publishes, and of those that `before` had left out, which are looked at again.
std::unordered_set<std::string> unpublished_names(const Program& before,
                                                  const CheckedProgram& edited)
{
    std::unordered_set<std::string> names;
    for (const GlobalVariable& each : before.variables) {
        std::string name = fold_name(each.name);
        const GlobalVariable* const found = edited.variable(name);
        if (found == nullptr || found->publish == NetworkPublish::Hidden) {
            names.insert(std::move(name));
        }
    }
    for (const LeftOut& each : before.left_out) {
        if (each.kind == LeftOut::Kind::Variable) {
            names.insert(fold_name(each.declared.name));
        }
    }
    return names;
}

/// The variables of the image that are RETAIN in `edited` but were not in `before`.
std::vector<ProgramImageAddition> retained_anew(const CheckedProgram& before, const Program& edited,
                                                const Handles& in_image)
{
    std::vector<ProgramImageAddition> all;
    for (std::size_t i = 0; i < edited.variables.size(); ++i) {
        const GlobalVariable& variable = edited.variables[i];
        if (!variable.is_retained) {
            continue;
        }
        const std::string name = fold_name(variable.name);
        const GlobalVariable* const old = before.variable(name);
        const auto handle = in_image.find(name);
        if (old != nullptr && !old->is_retained && handle != in_image.end()) {
            all.push_back({handle->second, {i}, nullptr});
        }
    }
    return all;
}

} // namespace

/// The handles for new variables. All memory is reserved before the handles are known, so that
/// giving them cannot fail.
struct PublishedProgram::NewHandles {
    NewHandles(const Handles& before, const Program& program, std::span<const std::size_t> indices,
               const Publication& publication)
        : in_image{before}
    {
        for (const std::size_t index : indices) {
            const auto place = in_image.emplace(fold_name(program.variables[index].name), 0).first;
            added.push_back(&place->second);
        }
        for (const PublishedVariable& each : publication.published()) {
            published.push_back(&in_image.at(fold_name(each.variable->name)));
        }
        handles.reserve(published.size());
    }
    /// Assigns consecutive handles, beginning with `first`, to the new variables.
    void give(std::uint32_t first) noexcept
    {
        for (std::uint32_t* const handle : added) {
            *handle = first++;
        }
        for (const std::uint32_t* const handle : published) {
            handles.push_back(*handle);
        }
    }

    Handles in_image;
    std::vector<std::uint32_t*> added;
    std::vector<const std::uint32_t*> published;
    std::vector<std::uint32_t> handles;
};

std::unique_ptr<PublishedProgram>
PublishedProgram::create(std::shared_ptr<const CheckedProgram> program,
                         const PublishingLimits& limits)
{
    auto result = std::make_unique<PublishedProgram>(Key{});
    result->editions_.push_back(std::move(program));
    PublishingLimits of_image = limits;
    of_image.allows_unions = false;
    result->publication_.emplace(result->types(), of_image);
    const auto indices = variables_of_image(result->types(), result->publication_->published(), {});
    result->take(NewHandles{{}, result->program(), indices, *result->publication_}, 0);
    return result;
}

Configured<std::unique_ptr<PublishedProgram>>
PublishedProgram::create(Program program, const PublishingLimits& limits)
{
    return CheckedProgram::create(std::move(program)).transform([&](auto checked) {
        return create(std::move(checked), limits);
    });
}

void PublishedProgram::take(NewHandles handles, std::uint32_t first) noexcept
{
    handles.give(first);
    in_image_ = std::move(handles.in_image);
    handles_ = std::move(handles.handles);
}

Configured<ProgramImage> PublishedProgram::make_image(std::uint16_t namespace_index,
                                                      const ProgramImageOptions& options) const
{
    return ProgramImage::create(
        types(), variables_of_image(types(), publication_->published(), {}),
        [&](const DerivedType& type) { return MachineTypes::encoding_of(namespace_index, type); },
        options);
}

Configured<void> PublishedProgram::check_edit(std::span<const Edition> editions,
                                              const CheckedProgram& edited)
{
    for (const Edition& before : editions) {
        if (auto same = detail::check_same_types(before->types(), edited.types()); !same) {
            return same;
        }
    }
    return detail::check_same_variables(*editions.back(), edited);
}

Configured<ProgramAddition> PublishedProgram::edit(Program edited, std::uint16_t namespace_index,
                                                   ProgramImage& image)
{
    return CheckedProgram::create(std::move(edited)).and_then([&](Edition checked) {
        return check_edit(editions_, *checked).and_then([&] {
            return edit(std::move(checked), namespace_index, image);
        });
    });
}

Configured<ProgramAddition> PublishedProgram::edit(Edition edited, std::uint16_t namespace_index,
                                                   ProgramImage& image)
{
    const ProgramTypes& types = edited->types();
    const CheckedProgram& current = *editions_.back();
    Handles in_image{in_image_};
    std::erase_if(in_image,
                  [&](const auto& each) { return edited->variable(each.first) == nullptr; });
    auto retained = retained_anew(current, types.program(), in_image);
    // Work on a copy, so that nothing has changed if the image cannot hold the variables.
    Publication publication{*publication_};
    auto removed = publication.remove(unpublished_names(current.program(), *edited));
    const PublicationGroup group = publication.add(types);
    const std::span<const PublishedVariable> added{publication.published()};
    const auto indices = variables_of_image(types, added.subspan(group.first_published), in_image);
    NewHandles handles{in_image, types.program(), indices, publication};
    editions_.reserve(editions_.size() + 1);
    auto placed = image.add(types, indices, [&](const DerivedType& type) {
        return MachineTypes::encoding_of(namespace_index, type);
    });
    if (!placed) {
        return Unexpected{std::move(placed).error()};
    }
    editions_.push_back(std::move(edited));
    *publication_ = std::move(publication);
    take(std::move(handles), placed->first_handle);
    return ProgramAddition{group, std::move(*placed), std::move(retained), std::move(removed),
                           &types};
}

} // namespace busbar::controller
