#include "schema.hpp"

#include <algorithm>
#include <fstream>
#include <set>

#include "names.hpp"

namespace busbar::generator {

namespace {

constexpr const char* only_group = "structures";

/// Orders the structures of a schema so that what stands in place is declared before.
class Layout {
public:
    explicit Layout(Schema& schema) : schema_{schema} {}

    /// A type that arrays lead back to itself gets is_recursive.
    void find_recursion();
    /// Returns all structures, each after those that it needs.
    [[nodiscard]] std::vector<const Type*> order();

private:
    [[nodiscard]] static std::set<const Type*> reachable(const Type& from);
    void visit(const Type& type, std::vector<const Type*>& order);

    Schema& schema_;
    std::unordered_map<const Type*, std::set<const Type*>> reach_;
    std::set<const Type*> visited_;
};

std::set<const Type*> Layout::reachable(const Type& from)
{
    std::set<const Type*> found;
    std::vector<const Type*> next{&from};
    while (!next.empty()) {
        const Type* const type = next.back();
        next.pop_back();
        for (const StructureField& field : type->fields) {
            if (field.type.structure != nullptr && found.insert(field.type.structure).second) {
                next.push_back(field.type.structure);
            }
        }
    }
    return found;
}

void Layout::find_recursion()
{
    for (Type& type : schema_.types) {
        if (type.is_structure()) {
            auto found = reachable(type);
            type.is_recursive = found.count(&type) != 0;
            reach_.emplace(&type, std::move(found));
        }
    }
}

void Layout::visit(const Type& type, std::vector<const Type*>& order)
{
    if (!visited_.insert(&type).second) {
        return;
    }
    for (const StructureField& field : type.fields) {
        const Type* const part = field.type.structure;
        // An array of a structure that leads back here does with a declaration of its name.
        if (part != nullptr && (field.value_rank < 1 || reach_.at(part).count(&type) == 0)) {
            visit(*part, order);
        }
    }
    order.push_back(&type);
}

std::vector<const Type*> Layout::order()
{
    std::vector<const Type*> result;
    for (const Type& type : schema_.types) {
        if (type.is_structure()) {
            visit(type, result);
        }
    }
    return result;
}

struct GroupRow {
    std::string type;
    std::string file;
    std::size_t line;
};

Expected<std::vector<GroupRow>, Failure> read_groups(const std::string& path)
{
    std::ifstream file{path};
    if (!file) {
        return Unexpected{path + ": cannot be opened"};
    }
    std::vector<GroupRow> rows;
    std::string text;
    for (std::size_t line = 1; std::getline(file, text); ++line) {
        const std::size_t comma = text.find(',');
        if (comma == std::string::npos) {
            return Unexpected{path + ":" + std::to_string(line) + ": found \"" + text +
                              "\", expected TypeName,file"};
        }
        rows.push_back({text.substr(0, comma), text.substr(comma + 1), line});
    }
    return rows;
}

/// Gives every structure its group; "*" in the file names that of all others.
Expected<void, Failure> assign_groups(Schema& schema, const std::string& path)
{
    std::string others = only_group;
    std::unordered_map<std::string, Type*> by_name;
    for (Type& type : schema.types) {
        by_name.emplace(type.name, &type);
    }
    auto rows = path.empty() ? std::vector<GroupRow>{} : read_groups(path);
    if (!rows) {
        return Unexpected{rows.error()};
    }
    for (const GroupRow& row : *rows) {
        const auto found = by_name.find(row.type);
        if (row.type == "*") {
            others = row.file;
        } else if (found == by_name.end()) {
            return Unexpected{path + ":" + std::to_string(row.line) + ": found " + row.type +
                              ", expected a structure of " + schema.namespace_uri};
        } else {
            found->second->group = row.file;
        }
        const bool is_new =
            std::none_of(schema.groups.begin(), schema.groups.end(),
                         [&](const Schema::Group& group) { return group.name == row.file; });
        if (is_new) {
            schema.groups.push_back({row.file, {}, {}});
        }
    }
    if (schema.groups.empty()) {
        schema.groups.push_back({others, {}, {}});
    }
    for (Type& type : schema.types) {
        type.group = type.group.empty() ? others : type.group;
    }
    return {};
}

/// The other groups that a group's structures need, or why they may not need them.
Expected<void, Failure> add_includes(Schema& schema, const nodeset::Document& document)
{
    std::set<std::string> before;
    for (Schema::Group& group : schema.groups) {
        std::set<std::string> needed;
        for (const Type* type : group.structures) {
            for (const StructureField& field : type->fields) {
                const Type* const part = field.type.structure;
                if (part == nullptr || part->group == group.name) {
                    continue;
                }
                if (before.count(part->group) == 0) {
                    return Unexpected{place(document, *type->node, type->node->line) + type->name +
                                      " of group " + group.name + " needs " + part->name + " of " +
                                      part->group + ", which comes later in the list of groups"};
                }
                needed.insert(part->group);
            }
        }
        group.includes.assign(needed.begin(), needed.end());
        before.insert(group.name);
    }
    return {};
}

} // namespace

Expected<void, Failure> lay_out(Schema& schema, const nodeset::Document& document,
                                const Options& options)
{
    if (auto assigned = assign_groups(schema, options.groups_file); !assigned) {
        return assigned;
    }
    Layout layout{schema};
    layout.find_recursion();
    for (const Type* type : layout.order()) {
        const auto group =
            std::find_if(schema.groups.begin(), schema.groups.end(),
                         [&](const Schema::Group& entry) { return entry.name == type->group; });
        group->structures.push_back(type);
    }
    return add_includes(schema, document);
}

} // namespace busbar::generator
