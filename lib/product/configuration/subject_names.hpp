#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/self_signed.hpp>

namespace busbar::product {

/// The owner's names for the own certificate when it is created.
struct SubjectNames {
    /// "{address}" stands for the machine's address (W588, 3-2-4); if empty, the server's name.
    std::string common_name{};
    std::string organization{"Busbar"};
    std::string locality{};
    std::string state{};
    std::string country{}; // two letters
    std::string organizational_unit{};

    friend bool operator==(const SubjectNames&, const SubjectNames&) = default;
};

/// A key of [certificates] for one of the names, with its maximum size in bytes (RFC 5280, A.1).
struct SubjectKey {
    std::string_view name;
    std::string SubjectNames::*member;
    std::size_t longest;
};

inline constexpr std::array subject_keys{
    SubjectKey{"common_name", &SubjectNames::common_name, 64},
    SubjectKey{"organization", &SubjectNames::organization, 64},
    SubjectKey{"locality", &SubjectNames::locality, 128},
    SubjectKey{"state", &SubjectNames::state, 128},
    SubjectKey{"country", &SubjectNames::country, 2},
    SubjectKey{"organizational_unit", &SubjectNames::organizational_unit, 64},
};

/// The default names of the products in W588 (3-2-4, 5-1-1).
[[nodiscard]] SubjectNames nj501_subject();

/// The names in a certificate for these hosts. The first is the one that clients get; the address
/// is the first that other machines can use.
[[nodiscard]] crypto::CertificateSubject subject_of(const SubjectNames& names,
                                                    const std::string& server_name,
                                                    const std::vector<std::string>& hosts);

} // namespace busbar::product
