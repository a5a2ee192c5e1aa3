#include "subject_names.hpp"

#include "addresses.hpp"

namespace busbar::product {

namespace {

constexpr std::string_view address_mark = "{address}";

std::string common_name_of(const SubjectNames& names, const std::string& server_name,
                           const std::vector<std::string>& hosts)
{
    if (names.common_name.empty()) {
        return server_name;
    }
    std::string text = names.common_name;
    const std::size_t place = text.find(address_mark);
    if (place != std::string::npos) {
        text.replace(place, address_mark.size(), address_of(hosts));
    }
    return text;
}

} // namespace

SubjectNames nj501_subject()
{
    return {"NxOpcUaServer@{address}", "Omron Corporation", "Kyoto", "Kyoto", "JP"};
}

crypto::CertificateSubject subject_of(const SubjectNames& names, const std::string& server_name,
                                      const std::vector<std::string>& hosts)
{
    crypto::CertificateSubject subject;
    subject.common_name = common_name_of(names, server_name, hosts);
    subject.organization = names.organization;
    subject.locality = names.locality;
    subject.state = names.state;
    subject.country = names.country;
    subject.organizational_unit = names.organizational_unit;
    for (const std::string& host : hosts) {
        crypto::add_host(subject, host);
    }
    return subject;
}

} // namespace busbar::product
