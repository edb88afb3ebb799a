from grader_class.reports.lines import led_lines
from tests.grader.reports import samples


def test_a_diagnosis_leads_the_first_check_that_did_not_pass():
    report = samples.report(diagnosis=samples.diagnosis(check="stops"))
    led = [led_lines(report, verdict)[0] for verdict in report.verdicts]
    assert [line.startswith("Fix this first: ") for line in led] == [False, True, False, False]
