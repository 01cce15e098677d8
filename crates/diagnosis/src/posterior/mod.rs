//! Diagnosis by one Gaussian model: the robot file as prior, a smooth discrepancy, effects with physical priors, an unlisted class.
//!
//! Arrows point downwards only:
//!
//! ```text
//! diagnose     recordings -> rows -> posterior -> report
//! learn        healthy drives -> what the robot's file knows of itself
//! engine       rows -> posterior
//! report       verdict, findings, sentence, held-out errors, detectable sizes
//! search       screening, refits, explanations
//! hypothesis   windows, effects, products by piece, unlisted class
//! fit          baseline robot, discrepancy, joint fit
//! observations rows of all drives
//! evidence     noise, linear model; knows no robot
//! ```
//!
//! It stands beside the engine of tests one after the other and answers where [`crate::Engine::Posterior`] is asked for.
//!
//! Steps of its making on 20 concealed cases of one effect of 10 % of power and their 20 twins without it, by the robot's file alone
//! (`prove --only one --share 0.1 --seed 7001`). Named: the true set is the first or second explanation and nothing has less than 0.01.
//! Each step changed several choices at once, so that none of them is credited by itself.
//!
//! | | named | wrong | twins accused |
//! | --- | --- | --- | --- |
//! | no shares that healthy robots have of mechanisms, all windows alike | 16 of 20 | 2 | 6 of the first 16 |
//! | with such shares, and a prior for each kind of window | 14 of 20 | 1 | 0 of 20 |
//! | smaller shares, less discrepancy between meters, correlated sizes of ground and tows | 15 of 20 | 1 | 0 of 20 |
//!
//! Boards of what followed (`prove --engine posterior`), the true set first or second, three ways: by the file alone, by a file that was
//! calibrated on the healthy drives, and with these beside. Seed 7001 was tuned on; 7006 was fresh, and afterwards looked at for what was
//! misnamed; 7004 and 7005 were looked at for why healthy drives were `unexplained`: a few quick moves in a thousand seconds, which now count
//! as 3.5 standard deviations.
//!
//! | seed | share of power | file alone | calibrated file | healthy drives |
//! | --- | --- | --- | --- | --- |
//! | 7001 | 10 % | 16 of 20 | 15 of 20 | 18 of 20 |
//! | 7006 | 7 % | 12 of 16 | 13 of 16 | 13 of 16 |
//! | names given to healthy drives, 7004, 7005, 7007 and twins of 7006 | | 0 of 54 | 2 of 54 | 0 of 54 |
//!
//! With healthy drives, effects of 1.2 % of power (seed 7010): 3 of 16 while a mechanism had to change power by 2 %, 5 of 16 since it has to
//! change it by two thirds of what the model misses of the healthy drives, 8 of 16 by the engine of tests one after the other. Less of the
//! shares that healthy robots have of mechanisms, beside healthy drives, changes none of the 16.

pub(crate) mod diagnose;
pub(crate) mod engine;
pub(crate) mod evidence;
pub(crate) mod fit;
pub(crate) mod hypothesis;
pub(crate) mod learn;
pub(crate) mod observations;
pub(crate) mod report;
pub(crate) mod search;
