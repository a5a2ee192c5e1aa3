#include "transfer_nodes.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "permissions.hpp"
#include "rights.hpp"

namespace busbar::administration::detail {

namespace {

constexpr std::string_view transfers_prefix = "Transfers/";

std::string in_hexadecimal(std::span<const std::byte> bytes)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::byte each : bytes) {
        text += digits[std::to_integer<std::size_t>(each >> 4)];
        text += digits[std::to_integer<std::size_t>(each & std::byte{15})];
    }
    return text;
}

} // namespace

TransferNodes::TransferNodes(const Needs& needs)
    : server_{needs.server}, space_{needs.server.address_space()}, transfer_{needs.transfer},
      random_{needs.random}, clock_{needs.clock}, table_{needs.table}, worker_{needs.worker},
      files_{needs.transfer}, turns_{[this](const std::shared_ptr<server::CallBatch>& batch,
                                            std::size_t index) { serve(batch, index); },
                                     needs.log}
{
    turns_.set_server(server_);
}

NamedRoles TransferNodes::roles() const
{
    return {transfer_.readers, transfer_.writers};
}

NodeId TransferNodes::node_id(std::string_view below) const
{
    std::string text = std::string{transfers_prefix} + transfer_.name;
    if (!below.empty()) {
        text += "/" + std::string{below};
    }
    return NodeId{namespace_, String{text}};
}

Configured<void> TransferNodes::add_nodes()
{
    server_.add_source(*this);
    namespace_ = space_.namespace_index(server_.config().application_uri).value_or(1);
    if (const auto added = add_objects(); !added) {
        return misconfigured("transfer " + transfer_.name, "cannot be added to the address space",
                             added.error());
    }
    return {};
}

Result<void> TransferNodes::add_objects()
{
    model::NewNode node;
    node.id = node_id("");
    node.browse_name = QualifiedName{namespace_, String{transfer_.name}};
    node.parent = space_.find(id::ObjectsFolder);
    model::NewObject object;
    object.type_definition = NodeId{0, id::TemporaryFileTransferType};
    const auto transfer = space_.add_object(node, object);
    if (!transfer) {
        return fail(transfer.error());
    }
    space_.set_node_access(*transfer, access_of(Thing::Files, NodeClass::Object, roles()));
    for (std::size_t which = 0; which < methods_of_transfer; ++which) {
        if (auto added = add_method(which, *transfer); !added) {
            return added;
        }
    }
    if (auto added = add_timeout(*transfer); !added) {
        return added;
    }
    model::NewNode container;
    container.id = node_id("files");
    container.browse_name = QualifiedName{namespace_, "files"};
    container.parent = *transfer;
    const auto added = space_.add_object(container);
    if (!added) {
        return fail(added.error());
    }
    container_ = *added;
    model::NodeAccess nobody;
    nobody.role_permissions.clear(); // not null
    space_.set_node_access(container_, std::move(nobody));
    return {};
}

Result<void> TransferNodes::add_method(std::size_t which, model::NodeIndex parent)
{
    const Declared& method = declared[which];
    const auto added =
        add_declared_method(space_,
                            {.declaration = method.declaration,
                             .parent = parent,
                             .source = index(),
                             .handle = which,
                             .thing = method.changes ? Thing::FileChanges : Thing::Files},
                            roles());
    return added ? Result<void>{} : fail(added.error());
}

Result<void> TransferNodes::add_timeout(model::NodeIndex transfer)
{
    using Milliseconds = std::chrono::duration<double, std::milli>;
    model::NewNode node;
    node.id = node_id("/ClientProcessingTimeout"); // as those of files
    node.browse_name = QualifiedName{0, "ClientProcessingTimeout"};
    node.parent = transfer;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Duration};
    variable.value = Variant{Milliseconds{transfer_.client_processing_timeout}.count()};
    const auto added = space_.add_property(node, std::move(variable));
    if (!added) {
        return fail(added.error());
    }
    space_.set_node_access(*added, access_of(Thing::Files, NodeClass::Variable, roles()));
    return {};
}

Result<std::string> TransferNodes::new_name()
{
    std::array<std::byte, 16> bytes{};
    if (auto filled = random_.fill(bytes); !filled) {
        return fail(filled.error());
    }
    return in_hexadecimal(bytes);
}

Result<Array<Variant>> TransferNodes::keep(TransferFile file)
{
    auto name = new_name();
    if (!name) {
        return fail(name.error());
    }
    file.name = *name;
    file.modified = clock_.now();
    busbar::detail::Undo undo{[&] { remove_nodes(*name); }};
    if (const auto added = add_file(*name); !added) {
        return fail(added.error());
    }
    std::uint32_t handle = 0;
    Array<Variant> outputs;
    outputs.push_back(Variant{node_id(*name)});
    outputs.push_back(Variant{handle});
    if (!file.is_written) {
        outputs.push_back(Variant{NodeId{}}); // the file is already complete
    }
    handle = files_.add(std::move(file), now()).handle;
    outputs[1] = Variant{handle};
    undo.keep();
    return outputs;
}

Result<void> TransferNodes::add_file(const std::string& name)
{
    auto free = std::find(numbers_.begin(), numbers_.end(), std::string{});
    if (free == numbers_.end()) {
        free = numbers_.emplace(free);
    }
    *free = name;
    model::NewNode node;
    node.id = node_id(name);
    node.browse_name = QualifiedName{namespace_, String{name}};
    node.parent = container_;
    const NodeId type{0, id::FileType};
    const auto number = static_cast<std::uint64_t>(free - numbers_.begin());
    const auto added = add_file_object(space_, node, {type, index(), number}, roles());
    if (!added) {
        return fail(added.error());
    }
    for (std::size_t which = methods_of_transfer; which < declared.size(); ++which) {
        if (auto made = add_method(which, *added); !made) {
            return made;
        }
    }
    return {};
}

void TransferNodes::remove_nodes(const std::string& name)
{
    if (const model::NodeIndex node = space_.find(node_id(name)); node != model::no_node) {
        static_cast<void>(space_.remove(node));
    }
    std::replace(numbers_.begin(), numbers_.end(), name, std::string{});
}

void TransferNodes::drop(const TransferFile& file)
{
    remove_nodes(file.name);
    files_.remove(file);
}

TimePoint TransferNodes::now() const
{
    return server::RunningServer{server_}.latest_time();
}

void TransferNodes::expire()
{
    const auto is_here = [&](const Holder& holder) { return is_there(server_, holder); };
    while (const TransferFile* const file = files_.find_gone(now(), is_here)) {
        drop(*file);
    }
}

} // namespace busbar::administration::detail
