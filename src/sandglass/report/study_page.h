// The HTML page of a study: the figures of the paper with their verdicts, the plane of state points, every run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/report/figure_data.h"
#include "sandglass/study/collect.h"

namespace sandglass {

/// One HTML file that needs no other. Links lead to the reports of the runs, relative to `folder`, where the page will
/// stand.
std::string study_html(const Study& study, const std::vector<Figure>& figures, const std::filesystem::path& folder);

/// Writes `folder`/report.html, whole or not at all.
void write_study_report(const Study& study, const std::vector<Figure>& figures, const std::filesystem::path& folder);

/// A path as a relative URL: every byte but letters, digits and "-._~/" percent-encoded.
std::string url_of(const std::filesystem::path& path);

}  // namespace sandglass
