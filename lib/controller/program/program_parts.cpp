#include "program_parts.hpp"

#include <algorithm>
#include <utility>

#include <busbar/controller/program_types.hpp>

#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

/// Removes the namespaces from names of types: declarations in them are read as if they stood
/// outside.
class NamespaceExit {
public:
    explicit NamespaceExit(ReadingPass& pass) : pass_{&pass} {}

    void run()
    {
        if (pass_->namespaces.empty()) {
            return;
        }
        for (const DerivedType& type : pass_->program.types) {
            types_.insert(fold_name(type.name));
        }
        for (DerivedType& type : pass_->program.types) {
            leave(type.alias.type_name);
            for (Member& member : type.members) {
                leave(member.type.type_name);
            }
        }
        for (GlobalVariable& variable : pass_->program.variables) {
            leave(variable.type.type_name);
        }
        for (Extension& extension : pass_->extensions) {
            leave(extension.base);
        }
    }

private:
    void leave(std::string& name) const
    {
        std::size_t after = name.find('.');
        if (after == std::string::npos || types_.contains(fold_name(name))) {
            return;
        }
        std::size_t begin = 0;
        while (after != std::string::npos &&
               pass_->namespaces.contains(fold_name(name.substr(begin, after - begin)))) {
            begin = after + 1;
            after = name.find('.', begin);
        }
        name.erase(0, begin);
    }

    ReadingPass* pass_;
    std::unordered_set<std::string> types_{};
};

/// Returns the name of the file that a place is in.
std::string_view file_of(const ProgramParts& parts, const ProgramPlace& place)
{
    if (place.file != 0 && place.file <= parts.files.size()) {
        return parts.files[place.file - 1];
    }
    return parts.files.empty() && !parts.list.empty() ? parts.list.front().file
                                                      : std::string_view{};
}

/// Gives the structures that extend others all members.
Configured<void> extend_types(const ProgramParts& parts, ReadingPass& pass)
{
    if (pass.extensions.empty()) {
        return {};
    }
    InheritedMembers inherited{pass.program.types, pass.extensions, pass.memory};
    const std::vector<NotExtended> failed = inherited.run();
    if (inherited.is_exhausted()) {
        return misconfigured(place_text(file_of(parts, {}), {}),
                             "takes more than " + std::to_string(pass.limits.max_memory) +
                                 " bytes of memory with the members of extended structures");
    }
    for (const NotExtended& each : failed) {
        if (pass.unserved == Unserved::Refuse) {
            return misconfigured(place_text(file_of(parts, each.place), each.place), each.reason);
        }
        LeftOut one = left_out(LeftOut::Kind::Type, each.name, {}, each.place, each.reason);
        add_file(one, parts.files);
        pass.program.left_out.push_back(std::move(one));
    }
    return {};
}

Configured<Program> read_pass(const ProgramParts& parts, ReadingPass& pass)
{
    pass.program.files = parts.files;
    pass.program.left_out = parts.left_out;
    for (const ProgramPart& part : parts.list) {
        const std::size_t before = pass.program.left_out.size();
        pass.constants.set_file(part.file);
        pass.constants.set_list({});
        if (auto read = part.read(pass); !read) {
            return Unexpected{std::move(read).error()};
        }
        for (std::size_t i = before; i < pass.program.left_out.size(); ++i) {
            add_file(pass.program.left_out[i], parts.files);
        }
    }
    NamespaceExit{pass}.run();
    return extend_types(parts, pass).transform([&] { return std::move(pass.program); });
}

/// Returns the first mistake in a text of which nothing was understood; null if something was.
const LeftOut* not_understood(const Program& program)
{
    const auto is_part = [](const LeftOut& one) { return one.kind == LeftOut::Kind::Part; };
    const bool is_empty = program.types.empty() && program.variables.empty() &&
                          program.tasks.empty() && program.instances.empty();
    return is_empty && !program.left_out.empty() &&
                   std::all_of(program.left_out.begin(), program.left_out.end(), is_part)
               ? &program.left_out.front()
               : nullptr;
}

} // namespace

Configured<Program> read_parts(const ProgramParts& parts, const DeclarationLimits& limits,
                               Unserved unserved)
{
    ConstantTable constants;
    auto program = read_in_passes(constants, unserved, [&](Unserved choice) {
        MemoryBudget memory{limits.max_memory - std::min(limits.max_memory, parts.memory)};
        ReadingPass pass{constants, memory, limits, choice};
        return read_pass(parts, pass);
    });
    if (!program) {
        return program;
    }
    if (const LeftOut* first = not_understood(*program)) {
        const ProgramPlace& place = first->declared.place;
        return misconfigured(place_text(file_of(parts, place), place), first->problem.text);
    }
    settle_enumerators(*program);
    return program;
}

} // namespace busbar::controller::detail
