#pragma once

#include <string>
#include <utility>
#include <vector>

#include <busbar/controller/publishing.hpp>

/// Programs in a few words.
namespace busbar::controller::test {

[[nodiscard]] inline TypeUse use(ElementaryType type)
{
    return {.elementary = type};
}

[[nodiscard]] inline TypeUse use(std::string type)
{
    return {.type_name = std::move(type)};
}

[[nodiscard]] inline TypeUse array_of(TypeUse type, std::vector<Bounds> bounds)
{
    type.dimensions = std::move(bounds);
    return type;
}

/// With members m0, m1, and so on.
[[nodiscard]] inline DerivedType structure(std::string name, std::vector<TypeUse> members)
{
    DerivedType type{.name = std::move(name)};
    for (TypeUse& member : members) {
        type.members.push_back({"m" + std::to_string(type.members.size()), std::move(member)});
    }
    return type;
}

[[nodiscard]] inline DerivedType union_of(std::string name, std::vector<TypeUse> members)
{
    DerivedType type = structure(std::move(name), std::move(members));
    type.kind = DerivedType::Kind::Union;
    return type;
}

[[nodiscard]] inline GlobalVariable variable(std::string name, TypeUse type = {})
{
    return {
        .name = std::move(name), .type = std::move(type), .publish = NetworkPublish::PublishOnly};
}

/// Variables of INT, as many as are asked for: "V00000", "V00001".
[[nodiscard]] inline std::vector<GlobalVariable> numbered(std::size_t count)
{
    std::vector<GlobalVariable> variables;
    for (std::size_t i = 0; i < count; ++i) {
        std::string digits = std::to_string(i);
        digits.insert(0, digits.size() < 5 ? 5 - digits.size() : 0, '0');
        variables.push_back(variable("V" + digits));
    }
    return variables;
}

/// T1 is a structure of INT, T2 one of T1, and so on.
[[nodiscard]] inline std::vector<DerivedType> tower(int levels)
{
    std::vector<DerivedType> types{structure("T1", {use(ElementaryType::Int)})};
    for (int i = 2; i <= levels; ++i) {
        types.push_back(structure("T" + std::to_string(i), {use("T" + std::to_string(i - 1))}));
    }
    return types;
}

/// A program and what is published of it.
struct Published {
    explicit Published(Program from, PublishingLimits limits = nj501_publishing())
        : program{std::move(from)}, types{ProgramTypes::create(program).value()}, publication{
                                                                                      types, limits}
    {
    }
    Published(const Published&) = delete;
    Published& operator=(const Published&) = delete;

    [[nodiscard]] std::vector<std::string> names() const
    {
        std::vector<std::string> names;
        for (const PublishedVariable& one : publication.published()) {
            names.push_back(one.variable->name);
        }
        return names;
    }

    Program program;
    ProgramTypes types;
    Publication publication;
};

} // namespace busbar::controller::test
