#include "own_certificate_nodes.hpp"

#include <array>
#include <string>
#include <utility>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::administration::detail {

namespace {

struct CertificateFact {
    const char* name;
    std::uint32_t type;
    std::int32_t value_rank;
    Variant (*value)(const crypto::Certificate& certificate);
};

Variant host_names(const crypto::Certificate& certificate)
{
    Array<String> names;
    names.clear(); // not null
    for (const std::string& name : certificate.host_names()) {
        names.push_back(String{name});
    }
    return Variant{std::move(names)};
}

constexpr std::array certificate_facts{
    CertificateFact{"CommonName", id::String, -1,
                    [](const crypto::Certificate& certificate) {
                        return Variant{String{crypto::subject_of(certificate).common_name}};
                    }},
    CertificateFact{"Organization", id::String, -1,
                    [](const crypto::Certificate& certificate) {
                        return Variant{String{crypto::subject_of(certificate).organization}};
                    }},
    CertificateFact{"HostNames", id::String, 1, host_names},
    CertificateFact{
        "ValidFrom", id::UtcTime, -1,
        [](const crypto::Certificate& certificate) { return Variant{certificate.valid_from()}; }},
    CertificateFact{
        "ValidTo", id::UtcTime, -1,
        [](const crypto::Certificate& certificate) { return Variant{certificate.valid_to()}; }},
    CertificateFact{"Thumbprint", id::String, -1,
                    [](const crypto::Certificate& certificate) {
                        return Variant{String{certificate.thumbprint_text()}};
                    }},
};

Result<void> add_fact(server::Server& server, NodeTable& table, model::NodeIndex object,
                      const CertificateFact& fact)
{
    model::AddressSpace& space = server.address_space();
    const NodeId of_object = space.node_id(object);
    model::NewNode node;
    node.id = NodeId{of_object.namespace_index(), of_object.string().str() + "/" + fact.name};
    node.browse_name = QualifiedName{of_object.namespace_index(), fact.name};
    node.parent = object;
    model::NewVariable variable;
    variable.data_type = NodeId{0, fact.type};
    variable.value_rank = fact.value_rank;
    if (fact.value_rank == 1) {
        variable.array_dimensions = {0U};
    }
    const auto added = space.add_property(node, std::move(variable));
    if (!added) {
        return fail(added.error());
    }
    table.bind_value(space, *added, [&server, value = fact.value] {
        const auto& identity = server.config().identity;
        return identity && !identity->certificates.empty()
                   ? DataValue{value(identity->certificates.front())}
                   : DataValue{status::Bad_NoData};
    });
    return {};
}

} // namespace

Configured<void> add_own_certificate(server::Server& server, NodeTable& table)
{
    model::AddressSpace& space = server.address_space();
    const std::uint16_t own =
        space.namespace_index(server.config().application_uri).value_or(std::uint16_t{1});
    model::NewNode node;
    node.id = NodeId{own, "ServerConfiguration/OwnCertificate"};
    node.browse_name = QualifiedName{own, "OwnCertificate"};
    node.parent = space.find(id::ServerConfiguration);
    node.reference_type = NodeId{0, id::HasComponent};
    const auto object = space.add_object(node);
    Result<void> added = object ? Result<void>{} : fail(object.error());
    for (const CertificateFact& fact : certificate_facts) {
        added = added ? add_fact(server, table, *object, fact) : added;
    }
    return added ? Configured<void>{}
                 : misconfigured("certificates", "OwnCertificate cannot be added", added.error());
}

} // namespace busbar::administration::detail
