#include "own_certificate_methods.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"

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
    return texts(certificate.host_names());
}

Variant configured_subject(const crypto::CertificateSubject& subject)
{
    return Variant{String{text_of_names(subject)}};
}

Variant configured_hosts(const crypto::CertificateSubject& subject)
{
    std::vector<std::string> hosts = subject.dns_names;
    hosts.insert(hosts.end(), subject.ip_addresses.begin(), subject.ip_addresses.end());
    return texts(hosts);
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

Result<model::NodeIndex> add_property(model::AddressSpace& space, model::NodeIndex object,
                                      const std::string& name, std::uint32_t type, bool is_list)
{
    const NodeId of_object = space.node_id(object);
    model::NewNode node;
    node.id = NodeId{of_object.namespace_index(), of_object.string().str() + "/" + name};
    node.browse_name = QualifiedName{of_object.namespace_index(), name};
    node.parent = object;
    model::NewVariable variable;
    variable.data_type = NodeId{0, type};
    variable.value_rank = is_list ? 1 : -1;
    if (is_list) {
        variable.array_dimensions = {0U};
    }
    return space.add_property(node, std::move(variable));
}

Result<void> add_configured(model::AddressSpace& space, NodeTable& table, model::NodeIndex object,
                            const std::function<crypto::CertificateSubject()>& configured)
{
    using Make = Variant (*)(const crypto::CertificateSubject&);
    for (const auto& [name, make] :
         {std::pair<const char*, Make>{"ConfiguredSubject", configured_subject},
          {"ConfiguredHosts", configured_hosts}}) {
        const auto added = add_property(space, object, name, id::String, make == configured_hosts);
        if (!added) {
            return fail(added.error());
        }
        table.bind_value(space, *added,
                         [&configured, make = make] { return DataValue{make(configured())}; });
    }
    return {};
}

Result<void> add_fact(server::Server& server, NodeTable& table, model::NodeIndex object,
                      const CertificateFact& fact)
{
    model::AddressSpace& space = server.address_space();
    const auto added = add_property(space, object, fact.name, fact.type, fact.value_rank == 1);
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

Configured<void> add_own_certificate(server::Server& server, NodeTable& table,
                                     const std::function<crypto::CertificateSubject()>& configured)
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
    if (added && configured) {
        added = add_configured(space, table, *object, configured);
    }
    return added ? Configured<void>{}
                 : misconfigured("certificates", "OwnCertificate cannot be added", added.error());
}

} // namespace busbar::administration::detail
