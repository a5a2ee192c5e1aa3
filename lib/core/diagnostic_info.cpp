#include <busbar/core/diagnostic_info.hpp>

namespace busbar {

namespace {

std::unique_ptr<DiagnosticInfo> clone(const std::unique_ptr<DiagnosticInfo>& info)
{
    return info ? std::make_unique<DiagnosticInfo>(*info) : nullptr;
}

bool equal_fields(const DiagnosticInfo& a, const DiagnosticInfo& b)
{
    return a.symbolic_id == b.symbolic_id && a.namespace_uri == b.namespace_uri &&
           a.locale == b.locale && a.localized_text == b.localized_text &&
           a.additional_info == b.additional_info && a.inner_status_code == b.inner_status_code;
}

} // namespace

DiagnosticInfo::DiagnosticInfo(const DiagnosticInfo& other)
    : symbolic_id{other.symbolic_id}, namespace_uri{other.namespace_uri}, locale{other.locale},
      localized_text{other.localized_text}, additional_info{other.additional_info},
      inner_status_code{other.inner_status_code}, inner_diagnostic_info{
                                                      clone(other.inner_diagnostic_info)}
{
}

DiagnosticInfo& DiagnosticInfo::operator=(const DiagnosticInfo& other)
{
    if (this != &other) {
        *this = DiagnosticInfo{other};
    }
    return *this;
}

bool DiagnosticInfo::is_null() const
{
    return !symbolic_id && !namespace_uri && !locale && !localized_text && !additional_info &&
           !inner_status_code && !inner_diagnostic_info;
}

bool operator==(const DiagnosticInfo& a, const DiagnosticInfo& b)
{
    const DiagnosticInfo* left = &a;
    const DiagnosticInfo* right = &b;
    while (left != nullptr && right != nullptr) {
        if (!equal_fields(*left, *right)) {
            return false;
        }
        left = left->inner_diagnostic_info.get();
        right = right->inner_diagnostic_info.get();
    }
    return left == right;
}

} // namespace busbar
